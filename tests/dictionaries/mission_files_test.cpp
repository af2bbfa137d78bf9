// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/mission_files.hpp"
#include "dictionaries/xtce/packet_model.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/mission_copy.hpp"

#include <cstdio>
#include <cstdlib>

namespace dictionaries_mission_files_test {

using namespace aeolis;
using namespace aeolis::dictionary;
using tests::MissionCopy;

namespace {

std::string exported(const std::filesystem::path& directory) {
    std::vector<Finding> findings;
    const auto files = read_mission_files(directory, findings);
    REQUIRE(findings.empty());
    const auto text = one_file_of(files);
    INFO((text ? "" : text.error().message));
    REQUIRE(text);
    return *text;
}

struct WrittenFile {
    std::filesystem::path path =
        std::filesystem::temp_directory_path() / ("aeolis-export-" + std::to_string(::getpid()) + ".xml");
    explicit WrittenFile(const std::string& text) { std::ofstream{path, std::ios::binary} << text; }
    ~WrittenFile() { std::filesystem::remove(path); }
    WrittenFile(const WrittenFile&) = delete;
    WrittenFile& operator=(const WrittenFile&) = delete;
};

std::string first_finding(const std::string& text) {
    const WrittenFile file{text};
    const auto loaded = load(file.path);
    CHECK_FALSE(loaded.dictionary);
    return loaded.findings.empty() ? "" : loaded.findings.front().message;
}

}  // namespace

TEST_CASE("an exported dictionary loads again as the same one, octet for octet", "[dictionary][export]") {
    MissionCopy mission;
    // Signs that XML writes otherwise, and the other line ends.
    std::string anchors = mission.text("anchors.csv");
    anchors.replace(anchors.find("Time zero"), 9, "a & b < c > d");
    for (std::size_t at = 0; (at = anchors.find('\n', at)) != std::string::npos; at += 2) anchors.insert(at, 1, '\r');
    mission.write("anchors.csv", anchors);
    const WrittenFile file{exported(mission.path())};
    std::vector<Finding> findings;
    CHECK(read_mission_files(file.path, findings) == read_mission_files(mission.path(), findings));
    CHECK(findings.empty());
    const auto before = mission.load();
    const auto after = load(file.path);
    INFO(tests::lines_of(after));
    INFO(tests::lines_of(before));
    REQUIRE(before.dictionary);
    REQUIRE(after.dictionary);
    CHECK(after.dictionary->id == before.dictionary->id);  // follows every octet of every text
    CHECK(after.dictionary->timeline_version == before.dictionary->timeline_version);
    CHECK(after.dictionary->timeline.size() == before.dictionary->timeline.size());
    CHECK(exported(file.path) == exported(mission.path()));
}

TEST_CASE("an exported dictionary is read as any mission's XTCE, nothing in it unsupported", "[dictionary][export]") {
    std::vector<Finding> findings;
    Findings into{"exported.xml", findings};
    const auto model = xtce::read_packet_model(exported(tests::shipped_mission), into);
    for (const auto& finding : findings) UNSCOPED_INFO(finding.text());
    CHECK(findings.empty());
    const auto original = xtce::read_packet_model(tests::text_of(tests::shipped_mission / "msl.xml"), into);
    REQUIRE(model);
    REQUIRE(original);
    CHECK(model->containers.size() == original->containers.size());
    CHECK(model->parameters.size() == original->parameters.size());
}

TEST_CASE("an exported dictionary validates against the XTCE 1.2 schema", "[dictionary][export]") {
    const std::filesystem::path schema = AEOLIS_SOURCE_DIR "/../shared/data/xtce";
    if (!std::filesystem::exists(schema / "SpaceSystemV1.2.xsd") ||
        std::system("command -v xmllint >/dev/null 2>&1") != 0) {
        std::printf("SKIPPED: xmllint is not installed, or the schema is not beside the project (../shared/data)\n");
        return;
    }
    const WrittenFile file{exported(tests::shipped_mission)};
    const auto validates = [&](const std::string& path) {
        return std::system(("XML_CATALOG_FILES='" + (schema / "catalog.xml").string() +
                            "' xmllint --nonet --noout --schema '" + (schema / "SpaceSystemV1.2.xsd").string() + "' '" +
                            path + "' >/dev/null 2>&1")
                               .c_str()) == 0;
    };
    CHECK(validates(file.path.string()));
    std::ofstream{file.path, std::ios::app} << "<More/>";
    CHECK_FALSE(validates(file.path.string()));
}

TEST_CASE("a file that holds no whole mission is refused in words", "[dictionary][export]") {
    CHECK(first_finding(tests::text_of(tests::shipped_mission / "msl.xml")).starts_with("holds no sheets"));
    CHECK(first_finding("no XML").starts_with("the XML does not parse"));
    std::string lacks = exported(tests::shipped_mission);
    const auto at = lacks.find("name=\"tones.csv\"");
    REQUIRE(at != std::string::npos);
    lacks.replace(at, 16, "name=\"other.csv\"");
    CHECK(first_finding(lacks).starts_with("is not in aeolis-export-"));

    std::vector<Finding> findings;
    auto files = read_mission_files(tests::shipped_mission, findings);
    *files.sheets.back().text += '\0';
    CHECK(one_file_of(files).error().message == "tones.csv is missing, or holds an octet that XML cannot");
    files.xtce.text = "<SpaceSystem name='T'><AncillaryDataSet/></SpaceSystem>";
    CHECK(one_file_of(files).error().message.find("no place for the sheets") != std::string::npos);
}

}  // namespace dictionaries_mission_files_test
