// SPDX-License-Identifier: Apache-2.0
// Measures how fast another mission's packets become channel values, by its XTCE, against decoders of the same
// containers written by hand: one with fields at fixed places, one with a list as long as the packet says.
#include "telemetry/other_mission.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <span>
#include <string>
#include <vector>

namespace {

using namespace aeolis;

constexpr double fixed_goal = 0.5, dynamic_goal = 0.25;
constexpr std::size_t packets = 4096, list_max = 12;
constexpr int rounds = 100, parts = 5;

using Packets = std::vector<std::vector<std::uint8_t>>;

std::string xtce_text() {
    const auto integer = [](const char* name, int bits, const char* more = "") {
        return "<IntegerParameterType name='" + std::string(name) + "'><IntegerDataEncoding sizeInBits='" +
               std::to_string(bits) + "' " + more + "/></IntegerParameterType>";
    };
    std::string parameters, fixed;
    // Eight fields of each kind: whole numbers of 8 and 16 bits, signed of 16, reals of 32 and 64, and calibrated ones.
    for (const char* type : {"u8", "u16", "i16", "f32", "f64", "cal"})
        for (int i = 0; i < 8; ++i) {
            const std::string name = std::string(type) + "_" + std::to_string(i);
            parameters += "<Parameter name='" + name + "' parameterTypeRef='" + type + "'/>";
            fixed += "<ParameterRefEntry parameterRef='" + name + "'/>";
        }
    return "<SpaceSystem name='Bench'><TelemetryMetaData><ParameterTypeSet>" + integer("u5", 5) + integer("u11", 11) +
           integer("u32", 32) + integer("u8", 8) + integer("u16", 16) +
           integer("i16", 16, "encoding='twosComplement'") +
           "<FloatParameterType name='f32'><FloatDataEncoding sizeInBits='32'/></FloatParameterType>"
           "<FloatParameterType name='f64'><FloatDataEncoding sizeInBits='64'/></FloatParameterType>"
           "<FloatParameterType name='cal'><IntegerDataEncoding "
           "sizeInBits='16'><DefaultCalibrator><PolynomialCalibrator>"
           "<Term coefficient='-40' exponent='0'/><Term coefficient='0.025' exponent='1'/></PolynomialCalibrator>"
           "</DefaultCalibrator></IntegerDataEncoding></FloatParameterType></ParameterTypeSet><ParameterSet>"
           "<Parameter name='first' parameterTypeRef='u5'/><Parameter name='apid' parameterTypeRef='u11'/>"
           "<Parameter name='rest' parameterTypeRef='u32'/><Parameter name='COARSE' parameterTypeRef='u32'/>"
           "<Parameter name='FINE' parameterTypeRef='u16'/><Parameter name='N' parameterTypeRef='u8'/>"
           "<Parameter name='list' parameterTypeRef='u16'/>" +
           parameters +
           "</ParameterSet><ContainerSet><SequenceContainer name='Header' abstract='true'><EntryList>"
           "<ParameterRefEntry parameterRef='first'/><ParameterRefEntry parameterRef='apid'/>"
           "<ParameterRefEntry parameterRef='rest'/><ParameterRefEntry parameterRef='COARSE'/>"
           "<ParameterRefEntry parameterRef='FINE'/></EntryList></SequenceContainer>"
           "<SequenceContainer name='Fixed'><EntryList>" +
           fixed +
           "</EntryList><BaseContainer containerRef='Header'><RestrictionCriteria><Comparison parameterRef='apid' "
           "value='100'/></RestrictionCriteria></BaseContainer></SequenceContainer>"
           "<SequenceContainer name='Dynamic'><EntryList><ParameterRefEntry parameterRef='N'/>"
           "<ParameterRefEntry parameterRef='list'><RepeatEntry><Count><DynamicValue><ParameterInstanceRef "
           "parameterRef='N'/></DynamicValue></Count></RepeatEntry></ParameterRefEntry></EntryList>"
           "<BaseContainer containerRef='Header'><RestrictionCriteria><Comparison parameterRef='apid' value='101'/>"
           "</RestrictionCriteria></BaseContainer></SequenceContainer></ContainerSet></TelemetryMetaData></"
           "SpaceSystem>";
}

Packets packets_of(std::uint8_t apid, std::size_t data_octets) {
    Packets made;
    std::uint32_t noise = 1;
    for (std::size_t i = 0; i < packets; ++i) {
        const std::size_t size = apid == 101 ? 7 + 2 * (i % (list_max + 1)) : data_octets + 6;
        std::vector<std::uint8_t> octets(6 + size);
        for (auto& octet : octets) octet = static_cast<std::uint8_t>((noise = noise * 1664525U + 1013904223U) >> 25);
        octets[0] = 0;
        octets[1] = apid;
        octets[4] = 0;
        octets[5] = static_cast<std::uint8_t>(size - 1);
        if (apid == 101) octets[12] = static_cast<std::uint8_t>(i % (list_max + 1));
        made.push_back(std::move(octets));
    }
    return made;
}

/// Calls `each` on every packet repeatedly; returns the best rate of some parts, by processor time of this process.
template <typename Each>
double rate_per_s(const Packets& octets, Each each) {
    double best = 0.0;
    for (int part = 0; part < parts; ++part) {
        const std::clock_t start = std::clock();
        for (int round = 0; round < rounds / parts; ++round)
            for (const auto& packet : octets) each(packet);
        const double took_s = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
        best = std::max(best, static_cast<double>(rounds / parts) * static_cast<double>(octets.size()) / took_s);
    }
    return best;
}

// ---- by hand: the same fields, to the same form ------------------------------------------------------------------

struct Cursor {
    const std::uint8_t* at;
    std::uint64_t take(unsigned octets) {
        std::uint64_t value = 0;
        for (unsigned i = 0; i < octets; ++i) value = value << 8 | *at++;
        return value;
    }
};

bool begins(std::span<const std::uint8_t> packet, std::uint8_t apid, dictionary::Decoded& into, std::size_t fields) {
    if (packet.size() < 13 || packet[1] != apid) return false;
    into.raw.assign(fields, 0);
    into.value.assign(fields, std::nullopt);
    Cursor cursor{packet.data() + 6};
    into.header.time.seconds = static_cast<double>(cursor.take(4));
    into.header.time.seconds += static_cast<double>(cursor.take(2)) / 65536.0;
    const std::uint64_t rest = Cursor{packet.data() + 2}.take(4);
    const std::uint64_t header[] = {static_cast<std::uint64_t>(packet[0] >> 3U),
                                    static_cast<std::uint64_t>((packet[0] & 7U) << 8U | packet[1]), rest,
                                    Cursor{packet.data() + 6}.take(4), Cursor{packet.data() + 10}.take(2)};
    for (std::size_t i = 0; i < std::size(header); ++i) {
        into.raw[i] = header[i];
        into.value[i] = static_cast<double>(header[i]);
    }
    return true;
}

bool fixed_by_hand(std::span<const std::uint8_t> packet, dictionary::Decoded& into) {
    constexpr std::size_t fields = 5 + 48;
    if (packet.size() != 12 + 8 * (1 + 2 + 2 + 4 + 8 + 2) || !begins(packet, 100, into, fields)) return false;
    Cursor cursor{packet.data() + 12};
    std::size_t field = 5;
    const auto put = [&](std::uint64_t raw, double value) {
        into.raw[field] = raw;
        if (std::isfinite(value)) into.value[field] = value;
        ++field;
    };
    const auto whole = [&](std::uint64_t raw) { put(raw, static_cast<double>(raw)); };
    for (int i = 0; i < 8; ++i) whole(cursor.take(1));
    for (int i = 0; i < 8; ++i) whole(cursor.take(2));
    for (int i = 0; i < 8; ++i) put(0, static_cast<std::int16_t>(cursor.take(2)));
    for (int i = 0; i < 8; ++i)
        put(0, static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(cursor.take(4)))));
    for (int i = 0; i < 8; ++i) put(0, std::bit_cast<double>(cursor.take(8)));
    for (int i = 0; i < 8; ++i) {
        const auto raw = cursor.take(2);
        put(raw, -40.0 + 0.025 * static_cast<double>(raw));
    }
    return true;
}

bool dynamic_by_hand(std::span<const std::uint8_t> packet, dictionary::Decoded& into) {
    constexpr std::size_t fields = 6 + 16;
    if (!begins(packet, 101, into, fields)) return false;
    const std::size_t count = packet[12];
    if (packet.size() != 13 + 2 * count || count > 16) return false;
    into.raw[5] = count;
    into.value[5] = static_cast<double>(count);
    Cursor cursor{packet.data() + 13};
    for (std::size_t i = 0; i < count; ++i) {
        into.raw[6 + i] = cursor.take(2);
        into.value[6 + i] = static_cast<double>(into.raw[6 + i]);
    }
    return true;
}

}  // namespace

int main() {
    std::vector<dictionary::Finding> findings;
    dictionary::Findings into{"bench.xml", findings};
    auto model = dictionary::xtce::read_packet_model(xtce_text(), into);
    if (!model || !findings.empty()) return 1;
    const telemetry::OtherMission mission{std::move(*model), 1};

    bool reached = true;
    std::uint64_t sum = 0, wrong = 0;
    const auto compare = [&](const char* name, const Packets& octets, auto by_hand, double goal) {
        dictionary::Decoded decoded, expected;
        for (const auto& packet : octets)
            if (mission.decode(packet, decoded) || !by_hand(packet, expected) || decoded.value != expected.value)
                ++wrong;
        const double rate = rate_per_s(octets, [&](const auto& packet) {
            mission.decode(packet, decoded);
            sum += decoded.raw[1];
        });
        const double limit = rate_per_s(octets, [&](const auto& packet) {
            by_hand(packet, expected);
            sum += expected.raw[1];
        });
        std::printf("%-8s by XTCE %10.0f /s   by hand %10.0f /s   ratio %.2f   goal %.2f\n", name, rate, limit,
                    rate / limit, goal);
        reached = reached && rate / limit >= goal;
    };
    compare("fixed", packets_of(100, 8 * (1 + 2 + 2 + 4 + 8 + 2)), fixed_by_hand, fixed_goal);
    compare("dynamic", packets_of(101, 0), dynamic_by_hand, dynamic_goal);
    if (wrong > 0) std::printf("%llu packets differ\n", static_cast<unsigned long long>(wrong));
    std::printf("(%llu)\n", static_cast<unsigned long long>(sum & 1U));
    return reached && wrong == 0 ? 0 : 1;
}
