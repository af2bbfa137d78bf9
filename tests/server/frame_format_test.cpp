// SPDX-License-Identifier: Apache-2.0
#include "server/links/frame_format.hpp"
#include "tests/support/catch.hpp"

#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace server_frame_format_test {

using namespace aeolis;
using server::PacketStreamFormat;

namespace {

using Set = std::function<void(PacketStreamFormat&)>;

std::string refused(const char* format, const Set& set) {
    PacketStreamFormat told;
    told.name = format;
    set(told);
    const auto checked = server::check_format(told);
    if (checked) return {};
    CHECK(server::packet_source(told, {}, true).error().message == checked.error().message);
    return checked.error().message;
}

}  // namespace

TEST_CASE("options that a format does not use are refused by name, and those that it uses are not",
          "[server][frames][decode][ingest][downlink]") {
    const std::vector<std::pair<std::string, Set>> of_frames{
        {"--frame-octets", [](auto& format) { format.frame_octets = 256; }},
        {"--check-symbols", [](auto& format) { format.check_octets = 32; }},
        {"--reed-solomon", [](auto& format) { format.coded = false; }},
        {"--randomised", [](auto& format) { format.randomised = true; }},
        {"--fecf", [](auto& format) { format.crc = true; }},
        {"--virtual-channel", [](auto& format) { format.virtual_channel = 3; }},
    };
    const std::vector<std::pair<std::string, Set>> of_aos{
        {"--control-field", [](auto& format) { format.agreed.control_field = true; }},
        {"--header-error-control", [](auto& format) { format.agreed.header_error_control = true; }},
        {"--insert-octets", [](auto& format) { format.agreed.insert_octets = 2; }},
    };
    const auto begins = [](const std::string& name) { return Catch::StartsWith(name + ": of "); };
    for (const auto& [name, set] : of_frames) {
        CAPTURE(name);
        for (const char* format : {"packets", "pltu"}) CHECK_THAT(refused(format, set), begins(name));
        for (const char* format : {"tm", "aos", "cadu"}) CHECK(refused(format, set).empty());
    }
    for (const auto& [name, set] : of_aos) {
        CAPTURE(name);
        for (const char* format : {"packets", "pltu", "tm"}) CHECK_THAT(refused(format, set), begins(name));
        for (const char* format : {"aos", "cadu"}) CHECK(refused(format, set).empty());
    }
    const Set skip = [](auto& format) { format.skip = 4; };
    for (const char* format : {"pltu", "cadu"}) CHECK_THAT(refused(format, skip), begins("--skip"));
    for (const char* format : {"packets", "tm", "aos"}) CHECK(refused(format, skip).empty());
    CHECK(refused("x", skip) == "there is no format 'x': packets, tm, aos, cadu or pltu");
}

TEST_CASE("pointers that contradict packets again and again name the options to look at", "[server][frames][decode]") {
    const auto advice = [](const char* format, std::uint64_t agreed, std::uint64_t contradicted, int shift,
                           std::uint64_t shifted) {
        telemetry::PointerVerdicts verdicts;
        verdicts.agreed = agreed;
        verdicts.contradicted = contradicted;
        verdicts.shifts.at(static_cast<std::size_t>(shift + telemetry::PointerVerdicts::shift_max)) = shifted;
        PacketStreamFormat told;
        told.name = format;
        return server::pointers_contradict(told, verdicts);
    };
    CHECK(advice("aos", 0, 2, 4, 2).empty());
    CHECK(advice("aos", 20, 20, 4, 20).empty());
    CHECK_THAT(advice("aos", 0, 20, 4, 20), Catch::EndsWith("; look at --control-field"));
    CHECK_THAT(advice("cadu", 0, 20, -4, 20), Catch::EndsWith("; look at --control-field"));
    CHECK_THAT(advice("tm", 1, 20, 2, 15), Catch::EndsWith("; look at --fecf"));
    CHECK_THAT(advice("aos", 1, 20, 6, 15), Catch::EndsWith("; look at --control-field and --fecf"));
    CHECK_THAT(advice("aos", 0, 20, 0, 0),
               Catch::EndsWith("; look at --control-field, --fecf, --insert-octets and --header-error-control"));
}

}  // namespace server_frame_format_test
