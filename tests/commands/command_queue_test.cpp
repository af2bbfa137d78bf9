// SPDX-License-Identifier: Apache-2.0
#include "commands/command_queue.hpp"

#include "tests/support/catch.hpp"

namespace commands_command_queue_test {

using namespace aeolis;
using namespace aeolis::commands;

using Numbers = std::vector<std::uint64_t>;

namespace {

/// All that leave at that instant.
Numbers leaving(CommandQueue& queue, Ert now) {
    Numbers all;
    while (const auto number = queue.take_next(now)) all.push_back(*number);
    return all;
}

}  // namespace

TEST_CASE("of commands that are due the more urgent leaves first, of equals the older", "[commands][queue]") {
    CommandQueue queue;
    queue.add({.number = 1, .priority = 0, .release_at = {}, .held = false});
    queue.add({.number = 2, .priority = 5, .release_at = {}, .held = false});
    queue.add({.number = 3, .priority = 0, .release_at = {}, .held = false});
    queue.add({.number = 4, .priority = 5, .release_at = {}, .held = false});
    CHECK(leaving(queue, Ert{0}) == Numbers{2, 4, 1, 3});
    CHECK(leaving(queue, Ert{0}).empty());
}

TEST_CASE("askers take turns, each in its own order, and what passes ahead does so before all of them",
          "[commands][queue][R63]") {
    CommandQueue queue;
    for (std::uint64_t number = 1; number <= 4; ++number) queue.add({.number = number, .asker = "greedy"});
    queue.add({.number = 5, .asker = "careful"});
    queue.add({.number = 6, .asker = "careful"});
    queue.add({.number = 7, .precedence = Precedence::director, .asker = "director"});
    queue.add({.number = 8, .priority = 9, .asker = "greedy"});
    CHECK(leaving(queue, Ert{0}) == Numbers{7, 8, 5, 1, 6, 2, 3, 4});
}

TEST_CASE("hazardous commands leave first, and directors' leave every fourth turn to another",
          "[commands][queue][R63]") {
    CommandQueue queue;
    for (std::uint64_t number = 1; number <= 8; ++number)
        queue.add({.number = number, .precedence = Precedence::director, .asker = "director"});
    for (std::uint64_t number = 11; number <= 13; ++number) queue.add({.number = number, .asker = "careful"});
    queue.add({.number = 20, .precedence = Precedence::hazardous, .asker = "another"});
    CHECK(queue.take_next(Ert{0}, Precedence::hazardous) == 20U);
    CHECK_FALSE(queue.take_next(Ert{0}, Precedence::hazardous));
    CHECK(leaving(queue, Ert{0}) == Numbers{1, 2, 3, 11, 4, 5, 6, 12, 7, 8, 13});
}

TEST_CASE("who asks for one command at a time takes turns with who has a queue", "[commands][queue][R63]") {
    CommandQueue queue;
    for (std::uint64_t number = 1; number <= 3; ++number) queue.add({.number = number, .asker = "patient"});
    Numbers left;
    for (std::uint64_t number = 11; number <= 13; ++number) {
        queue.add({.number = number, .priority = 9, .asker = "one at a time"});
        for (int i = 0; i < 2; ++i) left.push_back(queue.take_next(Ert{0}).value_or(0));
    }
    CHECK(left == Numbers{11, 1, 12, 2, 13, 3});
}

TEST_CASE("a command with a time leaves then and not before", "[commands][queue]") {
    CommandQueue queue;
    queue.add({.number = 1, .priority = 9, .release_at = Ert{100}, .held = false});
    queue.add({.number = 2, .priority = 0, .release_at = {}, .held = false});
    CHECK(leaving(queue, Ert{99}) == Numbers{2});
    CHECK(leaving(queue, Ert{100}) == Numbers{1});
}

TEST_CASE("a held command waits for its release, and then for its time; a cancelled one never leaves",
          "[commands][queue]") {
    CommandQueue queue;
    queue.add({.number = 1, .priority = 0, .release_at = Ert{100}, .held = true});
    queue.add({.number = 2, .priority = 0, .release_at = {}, .held = true});
    CHECK(leaving(queue, Ert{200}).empty());
    CHECK(queue.release(1));
    CHECK(leaving(queue, Ert{50}).empty());
    CHECK(leaving(queue, Ert{100}) == Numbers{1});
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
    CHECK(leaving(queue, Ert{499}).empty());
    CHECK(queue.release(2));
    CHECK(leaving(queue, Ert{500}) == Numbers{1, 2});
    CHECK(leaving(queue, Ert{900}) == Numbers{3});
}

TEST_CASE("what comes back into the queue leaves by its number, before what was asked for later", "[commands][queue]") {
    CommandQueue queue;
    queue.add({.number = 2, .priority = 0, .release_at = {}, .held = true});
    queue.add({.number = 3, .priority = 5, .release_at = {}, .held = false});
    queue.add({.number = 1, .priority = 0, .release_at = Ert{100}, .held = false});
    CHECK(queue.due(3, Ert{0}));
    CHECK_FALSE(queue.due(2, Ert{0}));
    CHECK_FALSE(queue.due(1, Ert{99}));
    CHECK(queue.due(1, Ert{100}));
    CHECK_FALSE(queue.due(7, Ert{0}));
    CHECK(queue.take_all() == Numbers{3, 1, 2});
    CHECK(queue.waiting().empty());
}

TEST_CASE("those that are in order leave by their number, whatever their time, priority or hold; others pass them",
          "[commands][queue][R19]") {
    CommandQueue queue;
    queue.add(
        {.number = 1, .priority = 0, .release_at = Ert{100}, .held = false, .needs_approval = false, .in_order = true});
    queue.add({.number = 2, .priority = 9, .release_at = {}, .held = false, .needs_approval = false, .in_order = true});
    queue.add({.number = 3, .priority = 0, .release_at = {}, .held = true, .needs_approval = false, .in_order = true});
    queue.add({.number = 4, .priority = 0, .release_at = {}, .held = false});
    CHECK(queue.leaves_after(queue.waiting().front()) == 1);  // 2, the most urgent
    CHECK_FALSE(queue.due(2, Ert{0}));
    CHECK(leaving(queue, Ert{0}) == Numbers{4});
    CHECK(queue.release(3));
    CHECK(leaving(queue, Ert{99}).empty());
    CHECK(leaving(queue, Ert{100}) == Numbers{1, 2, 3});
}

TEST_CASE("when one in order comes to nothing those behind it wait until each is judged anew",
          "[commands][queue][R19]") {
    CommandQueue queue;
    for (const std::uint64_t number : {1, 2, 3, 4})
        queue.add({.number = number,
                   .priority = 0,
                   .release_at = {},
                   .held = number < 3,
                   .needs_approval = false,
                   .in_order = number != 4});
    CHECK(queue.cancel(2));
    CHECK(queue.doubt_after(2) == Numbers{3});
    CHECK(queue.release(1));
    CHECK(leaving(queue, Ert{0}) == Numbers{1, 4});
    CHECK(queue.release(3));  // nobody's word but this makes it leave
    CHECK(leaving(queue, Ert{0}).empty());
    CHECK(queue.judged(3));
    CHECK_FALSE(queue.judged(3));
    CHECK(leaving(queue, Ert{0}) == Numbers{3});
}

}  // namespace commands_command_queue_test
