// SPDX-License-Identifier: Apache-2.0
#include "common/spk.hpp"

#include "common/daf.hpp"

#include <cmath>

namespace aeolis {
namespace {

constexpr std::int32_t lagrange_type = 9, hermite_type = 13;
constexpr std::size_t state_numbers = 6;
constexpr std::size_t directory_step = 100;  // every hundredth epoch, but not the last
constexpr std::size_t degree_max = 27;       // [naif-spk]

std::size_t directory_of(std::size_t epochs) {
    return (epochs - 1) / directory_step;
}
/// States that a polynomial of the degree is drawn through.
std::size_t states_of(std::int32_t type, std::size_t degree) {
    return type == hermite_type ? (degree + 1) / 2 : degree + 1;
}

// Layout: states | epochs | every hundredth epoch | window | number of states. The window is the degree of type 9, and
// one less than the number of states taken of type 13.
Result<Ephemeris> states_in(const DafArray& array, std::int32_t type) {
    const auto wrong = [&](const std::string& what) { return Error{"segment '" + array.name + "' " + what}; };
    if (array.data.size() < state_numbers + 3) return wrong("is too short for one state");
    const double count = array.data.back(), window = array.data[array.data.size() - 2];
    if (!(count >= 1.0 && count * (state_numbers + 1) <= static_cast<double>(array.data.size())) ||
        count != std::floor(count))
        return wrong("has an impossible number of states");
    const auto states = static_cast<std::size_t>(count);
    if (array.data.size() != states * (state_numbers + 1) + directory_of(states) + 2)
        return wrong("is not as long as its " + std::to_string(states) + " states make it");
    if (!(window >= 0.0 && window < static_cast<double>(degree_max) + 1.0) || window != std::floor(window))
        return wrong("is interpolated by more states than SPICE takes");
    Ephemeris ephemeris;
    ephemeris.interpolation = type == hermite_type ? Interpolation::hermite : Interpolation::lagrange;
    ephemeris.degree = static_cast<std::size_t>(type == hermite_type ? 2.0 * window + 1.0 : window);
    ephemeris.start = {array.numbers[0]};
    ephemeris.stop = {array.numbers[1]};
    for (std::size_t i = 0; i < states; ++i) {
        EphemerisState state;
        state.time = {array.data[states * state_numbers + i]};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            state.position_km.at(axis) = array.data[i * state_numbers + axis];
            state.velocity_kmps.at(axis) = array.data[i * state_numbers + 3 + axis];
        }
        if (i > 0 && !(state.time > ephemeris.states.back().time)) return wrong("has epochs that do not ascend");
        ephemeris.states.push_back(state);
    }
    return ephemeris;
}

}  // namespace

Result<std::vector<SpkSegment>> read_spk(std::span<const std::uint8_t> file) {
    const auto daf = read_daf(file);
    if (!daf) return daf.error();
    if (daf->kind != "SPK") return Error{"is a kernel of the kind " + daf->kind + ", not SPK"};
    std::vector<SpkSegment> segments;
    for (const DafArray& array : daf->arrays) {
        if (array.numbers.size() != 2 || array.integers.size() != 4) return Error{"has summaries that no SPK has"};
        SpkSegment segment{array.name, array.integers[0], array.integers[1], array.integers[2], array.integers[3], {}};
        if (segment.type == lagrange_type || segment.type == hermite_type) {
            auto ephemeris = states_in(array, segment.type);
            if (!ephemeris) return ephemeris.error();
            segment.ephemeris = std::move(*ephemeris);
        }
        segment.ephemeris.object_id = std::to_string(segment.body);
        segments.push_back(std::move(segment));
    }
    return segments;
}

Result<std::vector<std::uint8_t>> write_spk(const std::vector<SpkSegment>& segments, std::string_view program) {
    Daf daf{"SPK", {}};
    if (segments.empty()) return Error{"no segment is to be written"};
    for (const SpkSegment& segment : segments) {
        const Ephemeris& ephemeris = segment.ephemeris;
        const bool hermite = ephemeris.interpolation == Interpolation::hermite;
        const std::int32_t type = hermite ? hermite_type : lagrange_type;
        const std::size_t taken = states_of(type, ephemeris.degree);
        if (ephemeris.states.size() < taken || ephemeris.degree < 1 || ephemeris.degree > degree_max ||
            (hermite && ephemeris.degree % 2 == 0))
            return Error{"segment '" + segment.name + "' has " + std::to_string(ephemeris.states.size()) +
                         " states, interpolated with degree " + std::to_string(ephemeris.degree)};
        DafArray array;
        array.name = segment.name;
        array.numbers = {ephemeris.start.seconds, ephemeris.stop.seconds};
        array.integers = {segment.body, segment.centre, segment.frame, type};
        for (const auto& state : ephemeris.states) {
            array.data.insert(array.data.end(), state.position_km.begin(), state.position_km.end());
            array.data.insert(array.data.end(), state.velocity_kmps.begin(), state.velocity_kmps.end());
        }
        for (const auto& state : ephemeris.states) array.data.push_back(state.time.seconds);
        for (std::size_t i = 1; i <= directory_of(ephemeris.states.size()); ++i)
            array.data.push_back(ephemeris.states[i * directory_step - 1].time.seconds);
        array.data.push_back(static_cast<double>(hermite ? taken - 1 : ephemeris.degree));
        array.data.push_back(static_cast<double>(ephemeris.states.size()));
        daf.arrays.push_back(std::move(array));
    }
    return write_daf(daf, program);
}

}  // namespace aeolis
