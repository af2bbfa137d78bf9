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

/// A decoder compiled once from the containers of fixed or count-dependent layout: of our own mission's packets
/// (telemetry/decommutator.hpp) and of others'. Gives the same values as ContainerDecoder.
///
/// In       the octets of a packet, any octets     Out   true, and the decoded fields; or false: the packet is none
///          of those, or incomplete; use ContainerDecoder
/// Compiled numbers, labels and flags, in aggregates too; validity by such a number before them; octets of fixed size,
///          which are passed over; repetitions as often as a number before them says; restrictions that compare whole
///          numbers. Not compiled: text, arrays, conditions on entries, times but coarse and fine counts, calibrations
///          by context
/// Rate     half of what a decoder written by hand reaches, for repetitions a quarter (bench/mission_decode_bench.cpp)
/// Memory   some 64 octets a field and container, at most 20 MB; what is beyond is not compiled
/// Many threads may share one.
class ContainerPlan {
  public:
    /// The field of a value in a container's packet; none: the value is not a field.
    using FieldOf = std::function<std::optional<std::size_t>(std::size_t container, std::size_t parameter,
                                                             const std::string& name)>;
    /// Compiles from the model's root. The model must outlive this.
    /// @param fields      the number of fields of each container's packet
    /// @param needs_text  whether a field's exact value is a text, by container and field
    ContainerPlan(const dictionary::xtce::PacketModel& model, const std::vector<std::size_t>& fields,
                  const FieldOf& field_of, const std::function<bool(std::size_t, std::size_t)>& needs_text);

    bool decode(std::span<const std::uint8_t> packet, dictionary::Decoded& into) const;

    /// The most derived container whose restrictions a packet meets.
    struct Reached {
        std::size_t container = 0;
        bool abstract = false;  ///< nothing derived from it describes the packet
        bool cut = false;       ///< the packet ends within it
    };
    /// None: a container that is not compiled is in the way, or several describe the packet.
    std::optional<Reached> reach(std::span<const std::uint8_t> packet) const;
    /// Reads the fields of a packet that reached a container, and is not cut. None: it ends within a repetition.
    /// @return the end in bits of what was read
    std::optional<std::size_t> read(std::size_t container, std::span<const std::uint8_t> packet,
                                    dictionary::Decoded& into) const;

    /// The number of containers whose packets it decodes.
    std::size_t compiled() const;
    bool is_compiled(std::size_t container) const { return container < nodes_.size() && nodes_[container].compiled; }

  private:
    /// How a number is read; any: by its coding.
    enum class Load : std::uint8_t { u8, u16, u32, u64, i8, i16, i32, i64, f32, f64, bits, any };
    /// The number of repetitions: intercept + slope × the value of an earlier field.
    struct Count {
        std::uint32_t field = 0;
        double slope = 1.0, intercept = 0.0;
    };
    static constexpr std::uint32_t once = 0xFFFFFFFF;
    /// A run of adjacent numbers of one coding, with adjacent fields.
    struct Step {
        std::uint32_t position_bits =
            0;                    ///< where the layout before it is fixed; else from the end of the step before it
        std::uint32_t times = 1;  ///< repeated: at most so many are fields
        std::uint16_t field = 0;  ///< of the first
        std::uint8_t bits = 0;    ///< of one
        Load load = Load::any;
        bool text = false;           ///< its exact value is needed
        bool moves = false;          ///< position_bits counts from the end of the step before it
        bool skipped = false;        ///< it is not a field
        std::uint32_t count = once;  ///< of repetitions: in counts_
        const dictionary::xtce::Coding* coding = nullptr;
        const dictionary::xtce::Calibration* calibration = nullptr;  ///< null: none
        const double* line = nullptr;  ///< its two coefficients where it is a straight line
    };
    struct Test {
        std::uint32_t position_bits = 0;
        unsigned bits = 0;
        bool plain = false;  ///< unsigned, in the usual order
        const dictionary::xtce::Coding* coding = nullptr;
        dictionary::xtce::Condition::Operator op{};
        double wanted = 0.0;
    };
    /// Fields that are undefined unless all of some tests hold.
    struct Validity {
        std::vector<Test> tests;
        std::uint32_t field = 0;
    };
    /// Derived containers that each ask for a number of one field, sorted by it.
    struct Choice {
        std::uint32_t position_bits = 0;
        unsigned bits = 0;
        struct Each {
            std::uint64_t wanted = 0;
            std::size_t container = 0;
            bool alone = false;  ///< it asks for nothing else
        };
        std::vector<Each> each;
        std::vector<std::uint16_t> first;  ///< of each number; numbers beyond are wanted by none. Empty: searched for
    };
    /// Two whole numbers right after the primary header.
    struct Clock {
        std::uint32_t fine_bit = 0;
        std::uint8_t coarse_bits = 0, fine_bits = 0;
    };
    struct Node {
        bool compiled = false;  ///< false: packets that reach it are not decoded here
        bool abstract = false;
        bool fixed = true;       ///< all its steps stand at fixed places
        std::uint32_t bits = 0;  ///< of a whole packet, or up to the first repetition
        std::size_t fields = 0;
        bool fills = false;  ///< each field has its step
        std::vector<Step> steps;
        std::vector<Validity> valid;
        std::optional<Clock> clock;
        std::vector<Test> tests;  ///< all must hold, on the packet of its base; none: it has no restriction
        std::vector<std::size_t> derived;
        std::optional<Choice> choice;  ///< among them, instead of trying each
    };
    class Compiler;

    static bool holds(const Test& test, std::span<const std::uint8_t> packet);
    /// The derived container that describes a packet further. False: several do.
    bool next_of(const Node& node, std::span<const std::uint8_t> packet, const Node*& next) const;
    /// Where a packet's fields are written.
    struct Into {
        std::uint64_t* raw;
        std::optional<double>* value;
        std::vector<std::pair<std::size_t, std::string>>* texts;
    };
    template <typename LoadOne>
    static void read_each(const Step& step, std::size_t times, const Into& into, LoadOne load);
    static void read_step(const Step& step, std::span<const std::uint8_t> packet, std::size_t position_bits,
                          std::size_t times, const Into& into);
    bool read_repeated(const Step& step, std::span<const std::uint8_t> packet, std::size_t& position_bits,
                       const Into& into) const;

    std::optional<std::size_t> root_;
    std::vector<Node> nodes_;  ///< by container
    std::vector<Count> counts_;
};

}  // namespace aeolis::telemetry
