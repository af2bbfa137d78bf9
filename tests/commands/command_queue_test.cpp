#include "commands/command_queue.hpp"

#include "tests/support/catch.hpp"

using namespace aeolis;
using namespace aeolis::commands;

using Numbers = std::vector<std::uint64_t>;

TEST_CASE("of commands that are due the more urgent leaves first, of equals the older", "[commands][queue]") {
    CommandQueue queue;
    queue.add({.number = 1, .priority = 0, .release_at = {}, .held = false});
    queue.add({.number = 2, .priority = 5, .release_at = {}, .held = false});
    queue.add({.number = 3, .priority = 0, .release_at = {}, .held = false});
    queue.add({.number = 4, .priority = 5, .release_at = {}, .held = false});
    CHECK(queue.take_due(Ert{0}) == Numbers{2, 4, 1, 3});
    CHECK(queue.take_due(Ert{0}).empty());
}

TEST_CASE("a command with a time leaves then and not before", "[commands][queue]") {
    CommandQueue queue;
    queue.add({.number = 1, .priority = 9, .release_at = Ert{100}, .held = false});
    queue.add({.number = 2, .priority = 0, .release_at = {}, .held = false});
    CHECK(queue.take_due(Ert{99}) == Numbers{2});
    CHECK(queue.take_due(Ert{100}) == Numbers{1});
}

TEST_CASE("a held command waits for its release, and then for its time; a cancelled one never leaves", "[commands][queue]") {
    CommandQueue queue;
    queue.add({.number = 1, .priority = 0, .release_at = Ert{100}, .held = true});
    queue.add({.number = 2, .priority = 0, .release_at = {}, .held = true});
    CHECK(queue.take_due(Ert{200}).empty());
    CHECK(queue.release(1));
    CHECK(queue.take_due(Ert{50}).empty());
    CHECK(queue.take_due(Ert{100}) == Numbers{1});
    CHECK(queue.cancel(2));
    CHECK_FALSE(queue.release(2));
    CHECK_FALSE(queue.hold(7));
    CHECK(queue.waiting().empty());
}

TEST_CASE("what is due may be put off; what is held or not due yet keeps its time", "[commands][queue]") {
    CommandQueue queue;
    queue.add({.number = 1, .priority = 0, .release_at = {}, .held = false});
    queue.add({.number = 2, .priority = 0, .release_at = {}, .held = true});
    queue.add({.number = 3, .priority = 0, .release_at = Ert{900}, .held = false});
    CHECK(queue.postpone_due(Ert{0}, Ert{500}) == Numbers{1});
    CHECK(queue.take_due(Ert{499}).empty());
    CHECK(queue.release(2));
    CHECK(queue.take_due(Ert{500}) == Numbers{1, 2});
    CHECK(queue.take_due(Ert{900}) == Numbers{3});
}
