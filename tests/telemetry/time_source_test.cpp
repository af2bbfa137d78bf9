// SPDX-License-Identifier: Apache-2.0
#include "telemetry/packet_time.hpp"
#include "telemetry/time_source.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/octets.hpp"

namespace telemetry_time_source_test {

using namespace aeolis;
using namespace aeolis::telemetry;

namespace {

dictionary::xtce::PacketModel model_of() {
    const auto integer = [](int bits) {
        return "<IntegerParameterType name='u" + std::to_string(bits) + "'><IntegerDataEncoding sizeInBits='" +
               std::to_string(bits) + "'/></IntegerParameterType>";
    };
    const auto binary = [](int bits) {
        return "<BinaryParameterType name='b" + std::to_string(bits) +
               "'><BinaryDataEncoding><SizeInBits><FixedValue>" + std::to_string(bits) +
               "</FixedValue></SizeInBits></BinaryDataEncoding></BinaryParameterType>";
    };
    const auto aggregate = [](const std::string& name, const std::vector<int>& members) {
        std::string text = "<AggregateParameterType name='" + name + "'><MemberList>";
        for (std::size_t i = 0; i < members.size(); ++i)
            text += "<Member name='m" + std::to_string(i) + "' typeRef='u" + std::to_string(members[i]) + "'/>";
        return text + "</MemberList></AggregateParameterType>";
    };
    const std::string text =
        "<SpaceSystem name='S'><TelemetryMetaData><ParameterTypeSet>" + integer(8) + integer(16) + integer(32) +
        binary(48) + binary(56) + binary(64) + aggregate("cuc", {32, 16}) + aggregate("cds", {16, 32, 16}) +
        "</ParameterTypeSet><ParameterSet><Parameter name='N' parameterTypeRef='u32'/>"
        "<Parameter name='B6' parameterTypeRef='b48'/><Parameter name='B7' parameterTypeRef='b56'/>"
        "<Parameter name='B8' parameterTypeRef='b64'/><Parameter name='CUC' parameterTypeRef='cuc'/>"
        "<Parameter name='CDS' parameterTypeRef='cds'/></ParameterSet><ContainerSet>"
        "<SequenceContainer name='P'><EntryList><ParameterRefEntry parameterRef='N'/><ParameterRefEntry "
        "parameterRef='B6'/>"
        "<ParameterRefEntry parameterRef='B7'/><ParameterRefEntry parameterRef='B8'/><ParameterRefEntry "
        "parameterRef='CUC'/>"
        "<ParameterRefEntry parameterRef='CDS'/></EntryList></SequenceContainer></ContainerSet></TelemetryMetaData>"
        "</SpaceSystem>";
    std::vector<dictionary::Finding> findings;
    dictionary::Findings into{"m.xml", findings};
    auto model = dictionary::xtce::read_packet_model(text, into);
    REQUIRE(model);
    REQUIRE(findings.empty());
    return std::move(*model);
}

/// The time by a source in the test's packet, as "seconds epoch".
std::string time_by(const std::string& source) {
    const auto model = model_of();
    const auto parsed = TimeSource::parse(model, source);
    if (!parsed) return parsed.error().message;
    const ContainerDecoder decoder{model};
    const auto contents = decoder.decode(test::hex("000003e9"            // N: 1001
                                                   "00000010 8000"       // B6: 16.5
                                                   "1e 00000010 4000"    // B7: P-field of CUC, TAI, 4 + 2 octets
                                                   "0002 0000000a 01f4"  // B8: 2 days, 10 ms, 500 us
                                                   "00000020 c000"       // CUC
                                                   "0001 00000bb8 0001"));
    REQUIRE(contents.problem.empty());
    const auto time = parsed->time_in(contents.values);
    return time ? datum_text(time->seconds) + (time->epoch.empty() ? "" : " " + time->epoch) : "none";
}

}  // namespace

TEST_CASE("a packet's time is found in any parameter that is named: numbers, CUC, days with milliseconds, aggregates",
          "[telemetry][downlink][R54]") {
    CHECK(time_by("N") == "1001");
    CHECK(time_by("/S/N:milliseconds") == "1.001");
    CHECK(time_by("N:microseconds") == "0.001001");
    CHECK(time_by("B6:cuc") == "16.5");
    CHECK(time_by("B7:cuc-preamble") == "16.25 TAI");
    CHECK(time_by("B8:cds") == "172800.0105");
    CHECK(time_by("CUC") == "32.75");
    CHECK(time_by("CUC.m0") == "32");
    CHECK(time_by("CDS:cds") == "86403.000001");
}

TEST_CASE("a time that is not there, or not in that form, is none; a name that is not there is named",
          "[telemetry][downlink][R54]") {
    CHECK(time_by("B8:cuc") == "none");  // of eight octets it is none
    CHECK(time_by("B6:cuc-preamble") == "none");
    CHECK(time_by("B8:cds-preamble") == "none");
    CHECK_THAT(time_by("B6"), Catch::Contains("'B6' is octets: say :cuc, :cuc-preamble, :cds or :cds-preamble"));
    CHECK(time_by("B6:milliseconds") == "none");
    CHECK(time_by("N:cuc") == "none");
    CHECK(time_by("CDS") == "none");
    CHECK(time_by("CUC.x") == "none");
    CHECK_THAT(time_by("M"), Catch::StartsWith("there is no parameter 'M' in the XTCE file"));
    CHECK_THAT(time_by(""), Catch::StartsWith("there is no parameter ''"));
    CHECK_THAT(time_by("N:weeks"), Catch::StartsWith("there is no parameter 'N:weeks'"));
}

TEST_CASE("days with milliseconds are UTC: no leap second is added, and no day has more than 86 401 s",
          "[telemetry][decode][R54]") {
    const auto model = model_of();
    const auto in = [&](const std::string& source, const std::string& b7, const std::string& b8) {
        const auto contents = ContainerDecoder{model}.decode(
            test::hex("000003e9 000000108000" + b7 + b8 + "00000020c000 000100000bb80001"));
        REQUIRE(contents.problem.empty());
        const auto parsed = TimeSource::parse(model, source);
        REQUIRE(parsed);
        CHECK(parsed->is_defined_in(contents.values));
        return parsed->time_in(contents.values);
    };
    const std::string any7 = "1e000000104000", any8 = "00020000000a01f4";
    // 1958-01-01 and 20000 days; with kernels or without, since there is nothing to look up.
    const auto time = in("B7:cds-preamble", "404e200036ee80", any8);
    REQUIRE(time);
    CHECK(time_text(*time, {}) == "2012-278T01:00:00.000");
    CHECK(time->seconds == 20000 * 86400.0 + 3600.0);
    // The last day of 2016, 21549 days later, had a leap second.
    CHECK(time_text(*in("B7:cds-preamble", "40542d05265bff", any8), {}) == "2016-366T23:59:59.999");
    CHECK(time_text(*in("B7:cds-preamble", "40542d05265df4", any8), {}) == "2016-366T23:59:60.500");
    CHECK(time_text(*in("B7:cds-preamble", "40542d05265fe7", any8), {}) == "2016-366T23:59:60.999");
    CHECK_FALSE(in("B7:cds-preamble", "40542d05265fe8", any8));
    CHECK_FALSE(in("B8:cds", any7, "4e20055d4a800000"));  // 90 000 000 ms
    CHECK_FALSE(in("B8:cds", any7, "4e200000000103e8"));  // 1000 us of a millisecond
}

}  // namespace telemetry_time_source_test
