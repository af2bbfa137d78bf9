// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/xtce/entities.hpp"
#include "tests/support/catch.hpp"

#include <string>
#include <vector>

namespace dictionaries_entities_test {

using namespace aeolis::dictionary;

namespace {

struct Expanded {
    std::string text;  ///< "refused" where there is none
    std::vector<std::string> findings;
};

Expanded expanded(const std::string& text) {
    std::vector<Finding> found;
    Findings findings{"m.xml", found};
    Expanded result;
    result.text = xtce::with_entities(text, findings).value_or("refused");
    for (const auto& finding : found) result.findings.push_back(std::to_string(finding.line) + ": " + finding.message);
    return result;
}

const std::string declared = "<!DOCTYPE S [\n<!-- &no; -->\n<!ENTITY deg '\xC2\xB0'>\n<!ENTITY two \"a > b\">\n"
                             "<!ENTITY markup '<a/>'><!ENTITY nested '&deg;'><!ENTITY far SYSTEM 'x.xml'>\n]>";

}  // namespace

TEST_CASE("entities that a file declares as text are replaced, and those that all files have are left",
          "[dictionaries][xtce]") {
    const auto read = expanded(declared + "<S a='20&deg;C' b='&two;&amp;&#176;'/>");
    CHECK(read.text == declared + "<S a='20\xC2\xB0"
                                  "C' b='a > b&amp;&#176;'/>");
    CHECK(read.findings.empty());
    CHECK(expanded("<S/>").text == "<S/>");
    CHECK(expanded("<S a='a & b'/>").text == "<S a='a & b'/>");
}

TEST_CASE("an entity that is declared nowhere is a finding with its line, and stands as it is written",
          "[dictionaries][xtce]") {
    const std::string text = "<S>\n<!-- &a; -->\n<![CDATA[&b;\n]]><c d='20&deg;C'/></S>";
    const auto read = expanded(text);
    CHECK(read.text == text);
    CHECK(read.findings ==
          std::vector<std::string>{"4: entity '&deg;' is declared nowhere in the file: it stands as it is written"});
}

TEST_CASE("an entity of markup, of others or of another file is refused with its line", "[dictionaries][xtce]") {
    for (const std::string name : {"markup", "nested", "far"}) {
        const auto read = expanded(declared + "\n<S a='&" + name + ";'/>");
        CHECK(read.text == "refused");
        CHECK(read.findings == std::vector<std::string>{"7: entity '&" + name +
                                                        ";' is not text alone, and only such entities are read"});
    }
}

TEST_CASE("entities make no file longer without end, and an open DTD ends with its file", "[dictionaries][xtce]") {
    std::string text = "<!DOCTYPE S [<!ENTITY a '" + std::string(65536, 'x') + "'>]><S>";
    for (int i = 0; i < 100; ++i) text += "&a;";
    const auto read = expanded(text + "</S>");
    CHECK(read.text == "refused");
    CHECK(read.findings == std::vector<std::string>{"1: entity '&a;' makes the file too long"});
    for (const std::string open : {"<!DOCTYPE S [<!ENTITY a 'b", "<!DOCTYPE S [<!ENTITY", "<!DOCTYPE S [<!-- ",
                                   "<!DOCTYPE", "<!DOCTYPE S [<!ENTITY a 'b'>] "})
        CHECK(expanded(open + "&").text == open + "&");
}

}  // namespace dictionaries_entities_test
