// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/xtce/text_encoding.hpp"

#include "dictionaries/xtce/packet_model.hpp"
#include "tests/support/catch.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace dictionaries_text_encoding_test {

using namespace aeolis::dictionary;
using namespace aeolis::dictionary::xtce;
using namespace std::string_literals;

namespace {

struct Converted {
    std::string text;
    std::string problem;  ///< "line: message"
};

Converted converted(const std::string& text) {
    std::vector<Finding> findings;
    Findings into{"m.xml", findings};
    const auto utf8 = to_utf8(text, into);
    CHECK(findings.size() == (utf8 ? 0 : 1));
    return {utf8.value_or(""), findings.empty() ? "" : std::to_string(findings[0].line) + ": " + findings[0].message};
}

/// ASCII and "\xE9" in two octets a character.
std::string in_utf16(const std::string& text, bool little_endian, bool mark) {
    std::string octets;
    const auto add = [&](unsigned char high, unsigned char low) {
        octets += static_cast<char>(little_endian ? low : high);
        octets += static_cast<char>(little_endian ? high : low);
    };
    if (mark) add(0xFE, 0xFF);
    for (const char c : text) add(0, static_cast<unsigned char>(c));
    return octets;
}

std::string declares(const std::string& encoding, const std::string& rest) {
    return "<?xml version='1.0' encoding='" + encoding + "'?>\n" + rest;
}

}  // namespace

TEST_CASE("a file is read in the encoding of its mark or its declaration", "[dictionary][R54]") {
    for (const std::string& text :
         {"<a>\u00e9\u20ac</a>"s, "<?xml version=\"1.0\"?><a/>"s, declares("utf-8", "\u00e9")}) {
        CHECK(converted(text).text == text);
        CHECK(converted("\xEF\xBB\xBF" + text).text == text);
    }
    CHECK(converted(declares("US-ASCII", "a")).text == declares("US-ASCII", "a"));
    CHECK(converted(declares("iso-8859-1", "\xE9")).text == declares("iso-8859-1", "\u00e9"));
    CHECK(converted("<?xml version=\"1.0\" encoding = \"ISO-8859-1\" ?>\xB0").text ==
          "<?xml version=\"1.0\" encoding = \"ISO-8859-1\" ?>\u00b0");
    for (const bool little : {false, true})
        for (const bool mark : {false, true}) {
            const auto text = [&](const std::string& eacute) { return declares("UTF-16", "<a>" + eacute + "</a>"); };
            CHECK(converted(in_utf16(text("\xE9"), little, mark)).text == text("\u00e9"));
            const std::string named = declares(little ? "UTF-16LE" : "UTF-16BE", "<a/>");
            CHECK(converted(in_utf16(named, little, mark)).text == named);
        }
}

TEST_CASE("an encoding that is not read, or not the one declared, is refused by name", "[dictionary][R54]") {
    const auto problem = [](const std::string& text) {
        const auto done = converted(text);
        CHECK(done.text.empty());
        return done.problem;
    };
    CHECK_THAT(problem(declares("Windows-1252", "\x93")), Catch::Contains("1: encoding 'WINDOWS-1252' is not read"));
    CHECK_THAT(problem("\xFF\xFE\0\0<\0\0\0"s), Catch::Contains("1: the file is written in UTF-32"));
    CHECK_THAT(problem("\0\0\0<"s), Catch::Contains("UTF-32"));
    CHECK_THAT(problem("Lo\xA7\x94"), Catch::Contains("EBCDIC"));
    CHECK_THAT(problem(declares("UTF-16", "<a/>")), Catch::Contains("declares 'UTF-16' and is not written in it"));
    CHECK_THAT(problem(in_utf16(declares("UTF-8", ""), true, true)), Catch::Contains("declares 'UTF-8' and is not"));
    CHECK_THAT(problem(in_utf16(declares("UTF-16LE", ""), false, true)), Catch::Contains("'UTF-16LE' and is not"));
    CHECK_THAT(problem("\xEF\xBB\xBF" + declares("ISO-8859-1", "")), Catch::Contains("'ISO-8859-1' and is not"));
    CHECK_THAT(problem(in_utf16("<a/>", true, true) + "x"), Catch::Contains("not UTF-16 to its end"));
    CHECK_THAT(problem("<a>\n\n\xE9</a>"), Catch::StartsWith("3: octets that are no characters in UTF-8"));
    CHECK_THAT(problem(declares("US-ASCII", "\n\u00e9")), Catch::StartsWith("3: octets that are no characters"));
    for (const char* reference : {"&#xD800;", "&#0;", "&#1114112;", "&#x;", "&#12", "&#-1;"})
        CHECK_THAT(problem("<a>\n"s + reference + "</a>"), Catch::StartsWith("2: the reference '&#"));
    CHECK(converted("<a>&#233;&#x1F680;&amp;#</a>").problem.empty());
}

TEST_CASE("names of a Latin-1 file are UTF-8, and its lines stay those of the file", "[dictionary][xtce][R54]") {
    std::vector<Finding> findings;
    const auto model = read_packet_model(
        {{"m.xml", declares("ISO-8859-1", "<SpaceSystem name='T'><TelemetryMetaData>\n<ParameterTypeSet>"
                                          "<IntegerParameterType name='\xE9\xE9\xE9\xE9'/></ParameterTypeSet>\n"
                                          "<ParameterSet><Parameter name='Z\xE9' parameterTypeRef='no'/>"
                                          "</ParameterSet></TelemetryMetaData></SpaceSystem>")}},
        findings);
    REQUIRE(model);
    CHECK(model->parameters.at(0).name == "Z\u00e9");
    CHECK(std::ranges::any_of(findings, [](const Finding& finding) { return finding.line == 4; }));
    CHECK(std::ranges::none_of(findings, [](const Finding& finding) { return finding.line > 4; }));
}

}  // namespace dictionaries_text_encoding_test
