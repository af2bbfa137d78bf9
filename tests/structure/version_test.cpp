// SPDX-License-Identifier: Apache-2.0
#include "tests/structure/source_tree.hpp"
#include "tests/support/catch.hpp"

#include <regex>

namespace structure_version_test {

using namespace aeolis::structure;

namespace {

/// The first group of the first match of `pattern` in a file; empty where nothing matches.
std::string first_group(const std::string& file, const char* pattern) {
    const std::string text = text_of(file);
    std::smatch match;
    return std::regex_search(text, match, std::regex{pattern}) ? match[1].str() : std::string{};
}

}  // namespace

TEST_CASE("the version of the build is also that of the API, the console, its lock files and the newest change",
          "[structure]") {
    const std::string version = first_group("CMakeLists.txt", R"(project\(aeolis VERSION (\S+))");
    REQUIRE(!version.empty());
    CHECK(first_group("server/api/openapi.yaml", R"(\n  version: (\S+)\n)") == version);
    for (const std::string folder : {"web/", "web/openmct/"}) {
        INFO(folder);
        CHECK(first_group(folder + "package.json", R"re("version": "([^"]+)")re") == version);
        CHECK(first_group(folder + "package-lock.json", R"re("version": "([^"]+)")re") == version);
    }
    CHECK(first_group("CHANGELOG.md", R"(\n## (\S+))") == version);
    CHECK(first_group("docs/operations.md", R"(aeolis_([0-9.]+)_amd64\.deb)") == version);
}

}  // namespace structure_version_test
