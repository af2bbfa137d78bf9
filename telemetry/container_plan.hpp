// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/decoded.hpp"
#include "dictionaries/xtce/packet_model.hpp"

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace aeolis::telemetry {

/// The containers of a model whose fields stand at fixed places, compiled once: their packets are decoded without
/// looking at the XTCE again, to the same values as by ContainerDecoder.
///
/// In       the octets of a packet, any octets     Out   true, and the decoded fields; or false: the packet is none of
///          those, or not whole, and ContainerDecoder has to say what it is
/// Compiled numbers, labels and flags, in aggregates too; restrictions that compare whole numbers. Not compiled: text,
///          octets, arrays, repetitions, conditions on entries, times but coarse and fine counts, calibrations by context
/// Memory   some 64 octets a field and container
/// Many threads may share one.
class ContainerPlan {
  public:
    /// The field of a value in a container's packet; none: it is no field.
    using FieldOf = std::function<std::optional<std::size_t>(std::size_t container, std::size_t parameter,
                                                             const std::string& name)>;
    /// Compiles from the model's root. The model must outlive this.
    /// @param fields      the number of fields of each container's packet
    /// @param needs_text  whether a field's exact value is a text, by container and field
    ContainerPlan(const dictionary::xtce::PacketModel& model, const std::vector<std::size_t>& fields,
                  const FieldOf& field_of, const std::function<bool(std::size_t, std::size_t)>& needs_text);

    bool decode(std::span<const std::uint8_t> packet, dictionary::Decoded& into) const;

    /// The number of containers whose packets it decodes.
    std::size_t compiled() const;

  private:
    struct Step {
        std::uint32_t position_bits = 0;
        std::uint16_t field = 0;
        std::uint8_t bits = 0;
        bool text = false;  ///< its exact value is needed
        const dictionary::xtce::Coding* coding = nullptr;
        const dictionary::xtce::Calibration* calibration = nullptr;  ///< null: none
    };
    struct Test {
        std::uint32_t position_bits = 0;
        unsigned bits = 0;
        const dictionary::xtce::Coding* coding = nullptr;
        dictionary::xtce::Condition::Operator op{};
        double wanted = 0.0;
    };
    /// Two whole numbers right after the primary header.
    struct Clock {
        std::uint32_t fine_bit = 0;
        std::uint8_t coarse_bits = 0, fine_bits = 0;
    };
    struct Node {
        bool compiled = false;  ///< false: packets that reach it are not decoded here
        bool abstract = false;
        std::uint32_t bits = 0;  ///< of a whole packet
        std::size_t fields = 0;
        std::vector<Step> steps;
        std::optional<Clock> clock;
        std::vector<Test> tests;  ///< all must hold, on the packet of its base; none: it has no restriction
        std::vector<std::size_t> derived;
    };
    class Compiler;

    const Node* node_of(std::span<const std::uint8_t> packet) const;

    std::optional<std::size_t> root_;
    std::vector<Node> nodes_;  ///< by container
};

}  // namespace aeolis::telemetry
