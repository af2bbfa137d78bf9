// SPDX-License-Identifier: Apache-2.0
#include "server/procedures/yaml_document.hpp"
#include "tests/support/catch.hpp"

namespace server_procedures_yaml_document_test {

using namespace aeolis::server::procedures;

namespace {

std::string findings_of(const std::string& text) {
    std::string all;
    for (const auto& finding : read_yaml(text, "f.yaml").findings) all += finding.text() + "\n";
    return all;
}

}  // namespace

TEST_CASE("values are read with their places, columns in characters", "[procedures]") {
    const auto document = read_yaml("a: 1\nb:\n  - \"π\": {c: 'yes'}\n", "f.yaml");
    REQUIRE(document.root);
    CHECK(document.findings.empty());
    const YamlNode* a = document.root->member("a");
    REQUIRE(a != nullptr);
    CHECK(a->text == "1");
    CHECK(a->plain);
    CHECK(a->mark == Mark{1, 4});
    const YamlNode* b = document.root->member("b");
    REQUIRE(b != nullptr);
    REQUIRE(b->items.size() == 1);
    CHECK(b->items[0].keys[0].name == "π");
    CHECK(b->items[0].keys[0].mark == Mark{3, 5});
    const YamlNode* c = b->items[0].items[0].member("c");
    REQUIRE(c != nullptr);
    CHECK(c->mark == Mark{3, 14});
    CHECK_FALSE(c->plain);
    CHECK(document.root->member("c") == nullptr);
}

TEST_CASE("a byte order mark and lines that end as on Windows change nothing", "[procedures]") {
    const auto document = read_yaml("\xEF\xBB\xBF"
                                    "a: 1\r\nb: 2\r\n",
                                    "f.yaml");
    REQUIRE(document.root);
    CHECK(document.root->member("b")->mark == Mark{2, 4});
}

TEST_CASE("what is no YAML is refused with its place", "[procedures]") {
    CHECK_THAT(findings_of("a: [1\nb: 2\n"), Catch::StartsWith("f.yaml:2:2: no YAML: "));
    CHECK_THAT(findings_of("a:\n\t- 1\n"), Catch::StartsWith("f.yaml:2:1: no YAML: "));
    CHECK_THAT(findings_of("a: \"x\n"), Catch::StartsWith("f.yaml:2:1: no YAML: "));
    CHECK_THAT(findings_of("é: 1\nab\xFF: 2\n"), Catch::StartsWith("f.yaml:2:3: no text in UTF-8: "));
    CHECK_THAT(findings_of(std::string{"a: \x01\n"}), Catch::StartsWith("f.yaml:1:4: no text in UTF-8: "));
    CHECK(findings_of("") == "f.yaml:1:1: the file is empty\n");
    CHECK(findings_of("# nothing\n") == "f.yaml:1:1: the file is empty\n");
}

TEST_CASE("a key that stands twice is named, and the rest is read", "[procedures]") {
    const auto document = read_yaml("a: 1\na: {b: 2}\nc: 3\n", "f.yaml");
    REQUIRE(document.root);
    REQUIRE(document.findings.size() == 1);
    CHECK(document.findings[0].text() == "f.yaml:2:1: 'a' stands here a second time");
    CHECK(document.root->member("a")->text == "1");
    CHECK(document.root->member("c")->text == "3");
}

TEST_CASE("anchors, aliases, tags and a second document are refused, so that aliases of aliases cannot grow",
          "[procedures]") {
    CHECK(findings_of("a: &x 1\nb: *x\n") == "f.yaml:1:4: an anchor (&) stands here; a procedure has none\n");
    CHECK(findings_of("b: *x\n") == "f.yaml:1:4: an alias (*) stands here; write out what it stands for\n");
    CHECK(findings_of("a: !!float 1\n") == "f.yaml:1:4: a tag (!) stands here; a procedure has none\n");
    CHECK(findings_of("a: 1\n---\nb: 2\n") == "f.yaml:2:1: a second document begins; a file holds one\n");
    CHECK(findings_of("? [a]\n: 1\n") == "f.yaml:1:3: a list or table stands where a name is needed\n");
    std::string bomb = "a: &a [x, x, x, x, x, x, x, x, x]\n";
    for (char name = 'b'; name < 'z'; ++name) {
        bomb += std::string{name} + ": &" + name + " [";
        for (int i = 0; i < 9; ++i) bomb += std::string{"*"} + static_cast<char>(name - 1) + ", ";
        bomb += "]\n";
    }
    CHECK(findings_of(bomb) == "f.yaml:1:4: an anchor (&) stands here; a procedure has none\n");
}

TEST_CASE("size, depth, values and names of a table have limits", "[procedures]") {
    const auto nested = [](std::size_t depth) { return std::string(depth, '[') + std::string(depth, ']'); };
    CHECK(findings_of(nested(yaml_depth_max)).empty());
    CHECK(findings_of(nested(yaml_depth_max + 1)) == "f.yaml:1:13: nested deeper than 12 levels\n");
    CHECK(findings_of(nested(100'000)) == "f.yaml:1:13: nested deeper than 12 levels\n");

    std::string values;
    for (std::size_t i = 0; i < yaml_nodes_max - 1; ++i) values += "- a\n";
    CHECK(findings_of(values).empty());
    CHECK_THAT(findings_of(values + "- a\n"), Catch::EndsWith(": more than 20000 values\n"));

    std::string names;
    for (std::size_t i = 0; i < yaml_names_max; ++i) names += "n" + std::to_string(i) + ": 1\n";
    CHECK(findings_of(names).empty());
    CHECK_THAT(findings_of(names + "more: 1\n"), Catch::EndsWith(":201:1: more than 200 names in one table\n"));

    CHECK_THAT(findings_of("a: " + std::string(yaml_octets_max, 'x')), Catch::EndsWith(" octets, more than 262144\n"));
}

}  // namespace server_procedures_yaml_document_test
