// SPDX-License-Identifier: Apache-2.0
#include "server/archive/layouts.hpp"

#include "server/archive/archive.hpp"
#include "server/archive/reader.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <fmt/format.h>

namespace archive_layouts_test {

using namespace aeolis;
using namespace aeolis::archive;

namespace {

LayoutOutcome save(Archive& archive, const std::string& owner, const std::string& name, const std::string& view) {
    const auto outcome = archive.change_layout({owner, name, view, "2026-11-26T12:00:00Z"});
    REQUIRE(outcome);
    return *outcome;
}

std::string names_of(const std::filesystem::path& file, const std::string& owner) {
    auto reader = Reader::open(file, tests::shipped_dictionary());
    REQUIRE(reader);
    const auto layouts = reader->layouts(owner);
    REQUIRE(layouts);
    std::string names;
    for (const auto& layout : *layouts) names += layout.name + '=' + layout.view + ' ';
    return names;
}

}  // namespace

TEST_CASE("a layout is its owner's alone, is replaced under its name, and outlives the program", "[archive][layouts]") {
    const test::TemporaryFolder folder;
    {
        auto archive = Archive::open(folder / "a.db");
        REQUIRE(archive);
        CHECK(save(*archive, "ada", "entry", "data=links") == LayoutOutcome::done);
        CHECK(save(*archive, "ada", "approach", "low=alarms") == LayoutOutcome::done);
        CHECK(save(*archive, "", "entry", "") == LayoutOutcome::done);
        CHECK(save(*archive, "ada", "entry", "data=packets") == LayoutOutcome::done);
    }
    CHECK(names_of(folder / "a.db", "ada") == "approach=low=alarms entry=data=packets ");
    CHECK(names_of(folder / "a.db", "") == "entry= ");
    CHECK(names_of(folder / "a.db", "bob").empty());
}

TEST_CASE("a layout that is not there cannot be removed, and one that is, once", "[archive][layouts]") {
    const test::TemporaryFolder folder;
    auto archive = Archive::open(folder / "a.db");
    REQUIRE(archive);
    save(*archive, "ada", "entry", "data=links");
    const auto remove = [&](const char* owner) { return *archive->change_layout({owner, "entry", {}, {}}); };
    CHECK(remove("bob") == LayoutOutcome::absent);
    CHECK(remove("ada") == LayoutOutcome::done);
    CHECK(remove("ada") == LayoutOutcome::absent);
    CHECK(names_of(folder / "a.db", "ada").empty());
}

TEST_CASE("an owner has so many layouts and no more, whatever others have; the last can still be replaced",
          "[archive][layouts][bounds]") {
    const test::TemporaryFolder folder;
    auto archive = Archive::open(folder / "a.db");
    REQUIRE(archive);
    for (std::size_t i = 0; i < layouts_max; ++i)
        REQUIRE(save(*archive, "ada", fmt::format("l{}", i), "") == LayoutOutcome::done);
    CHECK(save(*archive, "ada", "more", "") == LayoutOutcome::full);
    CHECK(save(*archive, "ada", "l0", "data=links") == LayoutOutcome::done);
    CHECK(save(*archive, "bob", "more", "") == LayoutOutcome::done);
}

TEST_CASE("the name and the view of a layout are bounded and of plain letters", "[archive][layouts][bounds]") {
    for (const char* name : {"a", "Entry 2", "b_1.c-d"}) CHECK(check_layout_name(name).ok());
    CHECK(check_layout_name(std::string(layout_name_octets_max, 'x')).ok());
    for (const std::string& name :
         {std::string{}, std::string(layout_name_octets_max + 1, 'x'), std::string{" a"}, std::string{"a "},
          std::string{".."}, std::string{"a/b"}, std::string{"<b>x"}, std::string{"a\nb"}, std::string{"\xc3\xa4"}}) {
        INFO(name);
        REQUIRE_FALSE(check_layout_name(name).ok());
        CHECK_THAT(check_layout_name(name).error().message, Catch::StartsWith("name: "));
    }
    CHECK(check_layout_view("").ok());
    CHECK(check_layout_view("data=links&channels=mach,a+b%20c").ok());
    CHECK(check_layout_view(std::string(layout_view_octets_max, 'x')).ok());
    CHECK_THAT(check_layout_view(std::string(layout_view_octets_max + 1, 'x')).error().message,
               Catch::StartsWith("view: 2049 octets, at most 2048"));
    for (const char* view : {"a b", "a\nb", "\xc3\xa4"}) CHECK_FALSE(check_layout_view(view).ok());
}

}  // namespace archive_layouts_test
