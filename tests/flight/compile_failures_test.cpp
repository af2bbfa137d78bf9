// SPDX-License-Identifier: Apache-2.0
#include "tests/support/catch.hpp"
#include "tests/support/temporary_folder.hpp"

#include <cstdio>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>

namespace flight_compile_failures_test {

using namespace aeolis;

// What must not compile, by the compiler of this build: a check that is never broken is not known to hold.

namespace {

struct Compiled {
    bool ok = false;
    std::string errors;
};

/// Parses `source`, which may include what flight may.
Compiled compile(const std::string& source) {
    const test::TemporaryFolder folder;
    const std::string file = (folder / "tried.cpp").string();
    std::ofstream{file} << source;
    const std::string command = std::string{AEOLIS_COMPILER} +
                                " -std=c++20 -fsyntax-only -I" AEOLIS_SOURCE_DIR " -I" AEOLIS_BINARY_DIR
                                " -isystem " AEOLIS_EIGEN " " +
                                file + " 2>&1";
    Compiled compiled;
    FILE* const pipe = popen(command.c_str(), "r");
    REQUIRE(pipe != nullptr);
    for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) compiled.errors.push_back(static_cast<char>(c));
    compiled.ok = pclose(pipe) == 0;
    return compiled;
}

const std::string action_source = "#include \"flight/timeline/actions.hpp\"\n"
                                  "#line 12 \"timeline.csv\"\n"
                                  "constexpr auto run = aeolis::flight::action_named<\"NAME\">().run;\n";

/// A message like those of flight/kernel/message.hpp, with a field of that type, however deep.
std::string message_source(const std::string& field) {
    return "#include \"flight/kernel/only_data.hpp\"\n"
           "#include <cstdint>\n#include <span>\n#include <string_view>\n"
           "struct Inner { int count = 0; " +
           field +
           " it{}; };\n"
           "struct Told { std::optional<std::array<Inner, 2>> inner; };\n"
           "using Message = std::variant<Inner, Told>;\n"
           "constexpr void (*checked)(Message&) = aeolis::flight::expect_only_data_in_each;\n";
}

std::string with(std::string source, const std::string& name) {
    return source.replace(source.find("NAME"), 4, name);
}

}  // namespace

TEST_CASE("an action that flight does not have does not compile, by row, column and the nearest name",
          "[timeline][autocoder][R40][release]") {
    CHECK(compile(with(action_source, "vent_coolant")).ok);
    const Compiled misspelt = compile(with(action_source, "vent_colant"));
    CHECK_FALSE(misspelt.ok);
    CHECK_THAT(misspelt.errors, Catch::Contains("timeline.csv:12") && Catch::Contains("ColumnActionNamesNoAction"));
    // clang writes the letters of a template argument as numbers.
    if (std::string_view{AEOLIS_COMPILER}.find("clang") == std::string_view::npos)
        CHECK_THAT(misspelt.errors, Catch::Contains("\"vent_colant\"") && Catch::Contains("\"vent_coolant\""));
}

TEST_CASE("a message with a pointer or a view in it, however deep, does not compile", "[kernel][R3][release]") {
    const Compiled data = compile(message_source("double"));
    INFO(data.errors);
    CHECK(data.ok);
    for (const char* pointer : {"const std::uint8_t*", "std::span<const std::uint8_t>", "std::string_view"}) {
        INFO(pointer);
        const Compiled told = compile(message_source(pointer));
        CHECK_FALSE(told.ok);
        CHECK_THAT(told.errors, Catch::Contains("only_data.hpp"));
    }
}

}  // namespace flight_compile_failures_test
