// SPDX-License-Identifier: Apache-2.0
#include "server/cluster/run_messages.hpp"
#include "tests/support/catch.hpp"

#include <random>

namespace server_cluster_run_messages_test {

using namespace aeolis;
using namespace aeolis::server;
using cluster::messages_of;
using cluster::run_rows_of;

namespace {

/// A step whose rows take three messages: octets that are not packed into less.
archive::RunStep large_step() {
    std::mt19937 random{20261130};
    archive::RunStep step;
    step.dictionary = 7;
    step.before.set_seq(10);
    step.after.set_seq(20);
    auto& table = *step.rows.add_tables();
    table.set_table("raw_octets");
    for (std::size_t octet = 0; octet < cluster::piece_octets_max * 5 / 2; ++octet)
        table.mutable_values()->push_back(static_cast<char>(random()));
    return step;
}

v1::RunRows head_of(std::uint32_t run) {
    v1::RunRows head;
    head.set_archive("an archive");
    head.set_run(run);
    head.set_tables("tables");
    return head;
}

}  // namespace

TEST_CASE("a step travels in messages that an engine takes, and is joined again", "[cluster][R61]") {
    const auto step = large_step();
    const auto messages = messages_of(step, head_of(3));
    REQUIRE(messages.size() == 3);
    cluster::StepJoiner joiner;
    for (std::size_t piece = 0; piece < messages.size(); ++piece) {
        CHECK(messages[piece].size() < 1'000'000);
        auto message = run_rows_of(messages[piece]);
        REQUIRE(message);
        CHECK(message->dictionary() == 7);
        auto joined = joiner.join(std::move(*message));
        REQUIRE(joined);
        CHECK(joined->has_value() == (piece == 2));
        if (!*joined) continue;
        CHECK(archive::equal((*joined)->head.before(), step.before));
        CHECK(archive::equal((*joined)->head.after(), step.after));
        const auto rows = archive::unpacked((*joined)->octets);
        REQUIRE(rows);
        CHECK(rows->SerializeAsString() == step.rows.SerializeAsString());
    }
}

TEST_CASE("steps of two runs are joined each by itself, and a missing piece is told", "[cluster][R61]") {
    const auto one = messages_of(large_step(), head_of(1)), other = messages_of(large_step(), head_of(2));
    cluster::StepJoiner joiner;
    const auto join = [&](const std::string& message) { return joiner.join(*run_rows_of(message)); };
    CHECK(join(one[0]));
    CHECK(join(other[0]));
    CHECK(join(one[1]));
    const auto missing = join(other[2]);
    REQUIRE_FALSE(missing);
    CHECK(missing.error().message == "run 2: a piece of a step without the one before");
    const auto whole = join(one[2]);
    REQUIRE(whole);
    CHECK(whole->has_value());
    CHECK_FALSE(join(one[1]));  // after its end
}

TEST_CASE("octets that are no message of a run are refused", "[cluster][R61]") {
    v1::RunRows message = head_of(1);
    message.set_pieces(1);
    CHECK(run_rows_of(message.SerializeAsString()));
    message.set_piece(1);
    CHECK_FALSE(run_rows_of(message.SerializeAsString()));
    CHECK_FALSE(run_rows_of(head_of(0).SerializeAsString()));
    CHECK_FALSE(run_rows_of(""));
    CHECK_FALSE(run_rows_of("no message \xff\xfe"));
}

}  // namespace server_cluster_run_messages_test
