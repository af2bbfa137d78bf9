// SPDX-License-Identifier: Apache-2.0
#include "tests/structure/source_tree.hpp"
#include "tests/support/catch.hpp"

#include <regex>

namespace structure_documents_test {

using namespace aeolis::structure;

namespace {

namespace fs = std::filesystem;

bool is_in_repository(const fs::path& path) {
    return fs::exists(fs::path{AEOLIS_SOURCE_DIR} / path);
}

std::vector<std::string> linking_pages() {
    auto all = files_under("docs", {".md"});
    all.insert(all.end(), {"README.md", "CONTRIBUTING.md", "CHANGELOG.md", "SECURITY.md", "bench/README.md",
                           "web/README.md", "web/openmct/README.md"});
    return all;
}

std::vector<std::string> groups_of(const std::string& text, const std::regex& pattern) {
    std::vector<std::string> found;
    for (std::sregex_iterator it{text.begin(), text.end(), pattern}, end; it != end; ++it) found.push_back((*it)[1]);
    return found;
}

}  // namespace

TEST_CASE("every page links to files that exist", "[structure]") {
    static const std::regex link{R"(\]\(([^)#\s]+)[^)]*\))"};
    std::string dead;
    for (const std::string& page : linking_pages())
        for (const std::string& target : groups_of(text_of(page), link))
            if (target.find("://") == std::string::npos && !is_in_repository(fs::path{page}.parent_path() / target))
                dead += page + ": " + target + "\n";
    INFO(dead);
    CHECK(dead.empty());
}

TEST_CASE("the files and folders that the front pages and the glossary name exist", "[structure]") {
    static const std::regex path{
        R"(`((?:common|schema|dictionaries|flight|simulation|telemetry|commands|server|web|tests|bench|docs|setup)/[\w./-]*)`)"};
    std::string missing;
    for (const std::string page : {"README.md", "CONTRIBUTING.md", "SECURITY.md", "docs/glossary.md"})
        for (const std::string& name : groups_of(text_of(page), path))
            if (!name.starts_with("web/dist") && !name.starts_with("web/node_modules") && !is_in_repository(name))
                missing += page + ": " + name + "\n";
    INFO(missing);
    CHECK(missing.empty());
}

TEST_CASE(
    "the two ways through the ground have ten steps at most, each begins with its function, and all they name exist",
    "[structure]") {
    static const std::regex step{R"(^\d+\. `(?:\w+::)+\w+` )"}, function{R"(`((?:\w+::)*[A-Z]\w*::[a-z]\w*)`)"};
    std::vector<int> steps;  // of each list
    std::string section, wrong;
    bool inside = false;
    for (const std::string& line : lines_of("docs/architecture.md")) {
        if (line.starts_with("## ")) inside = line == "## The two ways through the ground";
        if (!inside) continue;
        section += line + "\n";
        if (line.starts_with("1. ")) steps.push_back(0);
        if (!steps.empty() && line.starts_with(std::to_string(steps.back() + 1) + ". ")) ++steps.back();
        if (!line.empty() && line.front() >= '0' && line.front() <= '9' && !std::regex_search(line, step))
            wrong += "begins with no function: " + line + "\n";
    }
    std::string sources;
    for (const std::string folder : {"telemetry", "commands", "server", "simulation"})
        for (const std::string& file : files_under(folder, {".cpp", ".hpp"})) sources += text_of(file);
    for (const std::string& name : groups_of(section, function)) {
        const auto method = name.rfind("::"), type = name.rfind("::", method - 1);
        const std::string of_class = type == std::string::npos ? name : name.substr(type + 2);
        const std::string class_name = of_class.substr(0, of_class.find("::"));
        const bool defined = sources.find(" " + of_class + "(") != std::string::npos;
        // Within a class in a .cpp, its functions are defined without its name.
        const auto declared = sources.find("\nclass " + class_name + " {");
        const bool within =
            declared != std::string::npos && sources.substr(declared, sources.find("\n};", declared) - declared)
                                                     .find(" " + name.substr(method + 2) + "(") != std::string::npos;
        if (!defined && !within) wrong += "no function " + name + "\n";
    }
    INFO(wrong);
    CHECK(wrong.empty());
    CHECK(steps == std::vector{10, 10});
}

}  // namespace structure_documents_test
