// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/decoded.hpp"
#include "dictionaries/xtce/packet_model.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace aeolis::telemetry {

/// A decoder compiled once from the containers, of our own mission's packets (telemetry/decommutator.hpp) and of
/// others'. Gives the same values as ContainerDecoder.
///
/// In       the octets of a packet, any octets
/// Out      true, and the decoded fields; or false: the packet is not whole, or its container is not compiled; use
///          ContainerDecoder
/// Compiled numbers, labels, flags, times, texts and octets; aggregates, arrays and repetitions of them; entries that a
///          condition includes, and places, sizes and counts that are told by numbers before them; values that are
///          valid, or calibrated, by such numbers; containers in containers. container_plan_compiler.cpp says what is
///          not
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
    static constexpr std::uint32_t none = 0xFFFFFFFF;
    static constexpr std::size_t kept_max = 32;       ///< chosen
    static constexpr std::size_t values_max = 32768;  ///< in lists: with more, ContainerDecoder's limits might be met

    /// How a number is read; any: by its coding.
    enum class Load : std::uint8_t { u8, u16, u32, u64, i8, i16, i32, i64, f32, f64, bits, any };
    /// A number that decides something: at a fixed place, or as its step kept it, without calibration.
    struct Operand {
        std::uint32_t position_bits = 0;
        std::uint32_t kept = none;
        unsigned bits = 0;
        bool plain = false;  ///< unsigned, in the usual order, without calibration
        const dictionary::xtce::Coding* coding = nullptr;
        const dictionary::xtce::Calibration* calibration = nullptr;  ///< null: none
    };
    /// A comparison, or several of which all or any must hold.
    struct Test {
        dictionary::xtce::Condition::Form form = dictionary::xtce::Condition::Form::all;
        std::vector<Test> parts{};
        Operand of{};
        dictionary::xtce::Condition::Operator op{};
        double wanted = 0.0;
    };
    /// A number of bits, octets or repetitions: that of the first case that holds; else intercept + slope × a number.
    struct Size {
        std::vector<std::pair<Test, double>> cases{};
        std::optional<Operand> of{};
        double slope = 1.0, intercept = 0.0;
        int more = 0;  ///< to be added, of a last index
    };
    struct Calibrator {
        const dictionary::xtce::Calibration* calibration = nullptr;  ///< null: none
        const double* line = nullptr;  ///< its two coefficients where it is a straight line
    };
    struct TimeScale {
        double offset_s = 0.0, scale_s = 1.0;
        bool absolute = false;  ///< the first one is the time of the packet
    };
    /// The first of several whose test holds is that of a value.
    using Contexts = std::vector<std::pair<Test, Calibrator>>;
    enum class Op : std::uint8_t {
        numbers,  ///< `times` numbers of one coding, with adjacent fields
        list,     ///< numbers, as many as `index` of sizes_ says; the first `times` are fields
        text,
        octets,
        move,  ///< by as many bits as `index` of sizes_ says
        when,  ///< the next `times` steps are done where `index` of tests_ holds
        loop,  ///< the next `times` steps are done as often as `index` of sizes_ says
    };
    struct Step {
        std::int32_t position_bits = 0;  ///< from the packet's begin; or, `moves`, from the end of the step before
        std::uint32_t times = 1;
        std::uint32_t index = none;
        std::uint32_t valid = none;     ///< in tests_: where it does not hold, the values are undefined
        std::uint32_t contexts = none;  ///< in contexts_
        std::uint32_t time = none;      ///< in times_
        std::uint32_t known = 0;        ///< of a loop: the number of repetitions that are fields
        std::uint16_t field = 0;        ///< of the first; of a loop: the number of fields of one repetition
        std::uint8_t bits = 0;          ///< of one number
        std::uint8_t kept = 0xFF;       ///< the place of the number in Run::kept; kept_max or more: not kept
        Op op = Op::numbers;
        Load load = Load::any;
        Load unaligned = Load::any;  ///< instead of `load`, between two octets
        bool text = false;           ///< its exact value is needed
        bool moves = false;
        bool skipped = false;  ///< it is not a field
        const dictionary::xtce::Coding* coding = nullptr;
        Calibrator calibrator{};
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
        bool fixed = true;       ///< all its steps are numbers at fixed places
        bool keeps = false;      ///< a step keeps its number
        std::uint32_t bits = 0;  ///< up to the last of its fixed places
        std::size_t fields = 0;
        bool fills = false;  ///< each field has its step
        std::vector<Step> steps;
        std::optional<Clock> clock;
        std::vector<Test> tests;  ///< all must hold, on the packet of its base; none: it has no restriction
        std::vector<std::size_t> derived;
        std::optional<Choice> choice;  ///< among them, instead of trying each
    };
    class Compiler;

    /// Where a packet's fields are written.
    struct Into {
        std::uint64_t* raw = nullptr;
        std::optional<double>* value = nullptr;
        std::vector<std::pair<std::size_t, std::string>>* texts = nullptr;
        std::size_t shift = 0;  ///< of fields, in a repetition
        bool fields = true;     ///< false: a repetition that is not fields
    };
    /// The decoding of one packet.
    struct Run {
        std::span<const std::uint8_t> packet;
        Into into;
        std::size_t at = 0, end_bits = 0;
        std::size_t values_left = values_max;
        std::optional<double> time_s;
        std::array<double, kept_max> kept;  ///< not a number: not read, or undefined
        std::size_t bits() const { return packet.size() * 8; }
    };

    /// `kept` may be null where the operand stands at a fixed place. Not a number: it has no value.
    static double value_of(const Operand& operand, std::span<const std::uint8_t> packet, const double* kept);
    /// None: it is not known.
    static std::optional<bool> judge(const Test& test, std::span<const std::uint8_t> packet, const double* kept);
    bool holds(std::uint32_t test, const Run& run) const;
    /// None: it is not known, or less than zero and not `signed_one`.
    std::optional<std::int64_t> evaluate(std::uint32_t size, const Run& run, bool signed_one = false) const;
    /// The derived container that describes a packet further. False: several do, or might.
    bool next_of(const Node& node, std::span<const std::uint8_t> packet, const Node*& next) const;
    template <typename LoadOne>
    static void read_each(const Step& step, const Calibrator& calibrator, std::size_t times, const Into& into,
                          LoadOne load);
    static void read_step(const Step& step, const Calibrator& calibrator, std::span<const std::uint8_t> packet,
                          std::size_t position_bits, std::size_t times, const Into& into);
    /// The calibrator of a step's numbers; null: they are undefined.
    const Calibrator* calibrator_of(const Step& step, const Run& run) const;
    void give(const Step& step, std::size_t position_bits, std::size_t times, Run& run) const;
    void give_decided(const Step& step, std::size_t position_bits, std::size_t times, Run& run) const;
    void give_times(const Step& step, std::size_t times, Run& run) const;
    bool run_node(const Node& node, std::span<const std::uint8_t> packet, dictionary::Decoded& into, Run& run) const;
    // They return false where the packet ends, or something cannot be known.
    bool run_steps(std::span<const Step> steps, Run& run) const;
    bool read_numbers(const Step& step, std::size_t count, std::size_t fields, Run& run) const;
    bool read_list(const Step& step, Run& run) const;
    bool read_text(const Step& step, Run& run) const;
    void give_text(const Step& step, std::size_t begin_bits, std::size_t text_bits, std::size_t size_bits,
                   const Run& run) const;
    bool pass_octets(const Step& step, Run& run) const;
    bool move(const Step& step, Run& run) const;
    bool repeat(const Step& step, std::span<const Step> steps, Run& run) const;

    std::optional<std::size_t> root_;
    std::vector<Node> nodes_;  ///< by container
    std::vector<Size> sizes_;
    std::vector<Test> tests_;
    std::vector<Contexts> contexts_;
    std::vector<TimeScale> times_;
};

}  // namespace aeolis::telemetry
