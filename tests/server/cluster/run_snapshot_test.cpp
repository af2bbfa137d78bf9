// SPDX-License-Identifier: Apache-2.0
#include "server/cluster/run_snapshot.hpp"
#include "tests/server/cluster/followed.hpp"
#include "tests/support/catch.hpp"

#include <random>

namespace server_cluster_run_snapshot_test {

using namespace aeolis;
using namespace aeolis::tests;
using cluster::RunSnapshot;

namespace {

/// All that is given of a run to somebody who holds so much of it.
std::vector<std::string> messages_of_run(const std::filesystem::path& file, RunId run,
                                         const v1::RunPosition& held = {}) {
    auto snapshot = RunSnapshot::begin(file, run, held);
    REQUIRE(snapshot);
    std::vector<std::string> messages;
    for (;;) {
        auto message = snapshot->next();
        REQUIRE(message);
        if (!*message) return messages;
        messages.push_back(std::move(**message));
    }
}

/// Takes the messages into an archive that follows, as far as their steps are complete.
void take_all(SharedArchive& copy, RunId run, std::string_view octets) {
    cluster::FramedMessages framed;
    framed.add(octets);
    cluster::StepJoiner joiner;
    for (auto message = framed.next();; message = framed.next()) {
        REQUIRE(message);
        if (!*message) return;
        auto step = joiner.join(std::move(**message));
        REQUIRE(step);
        if (!*step) continue;
        auto rows = archive::unpacked((*step)->octets);
        REQUIRE(rows);
        const auto taken =
            copy.take(run, {followed_dictionary.id, (*step)->head.before(), (*step)->head.after(), *rows}, "none 0");
        INFO((taken ? "" : taken.error().message));
        REQUIRE(taken);
    }
}

std::string joined(const std::vector<std::string>& messages) {
    std::string all;
    for (const auto& message : messages) all += message;
    return all;
}

/// An origin's archive with an identity, as one that is published.
struct Published {
    test::TemporaryFolder folder;
    std::filesystem::path file = folder / "origin.db";
    Archive archive = std::move(Archive::open(file)).value();
    std::string identity = *SharedArchive::open(file)->identity();
};

struct Following {
    Archive archive;
    SharedArchive shared;
    Following(const std::filesystem::path& file, const std::string& origin)
        : archive(std::move(Archive::open(file)).value()), shared(std::move(SharedArchive::open(file)).value()) {
        REQUIRE(shared.follow(origin));
    }
};

}  // namespace

TEST_CASE("a run that another server gives is the origin's, row by row, also in two parts", "[cluster][R61]") {
    Published origin;
    test::record_run(origin.archive, followed_dictionary, 12'000);
    test::add_note(origin.archive, RunId{1}, "the day after");
    const auto messages = messages_of_run(origin.file, RunId{1});
    REQUIRE(messages.size() > 1);
    const auto all = joined(messages);
    std::mt19937 random{20261130};
    for (int time = 0; time < 4; ++time) {
        const auto file = origin.folder.path() / ("copy_" + std::to_string(time) + ".db");
        Following copy{file, origin.identity};
        const auto cut = time == 0 ? all.size() : random() % all.size();
        INFO("cut after " << cut << " of " << all.size());
        take_all(copy.shared, RunId{1}, std::string_view{all}.substr(0, cut));
        if (time != 0) CHECK_FALSE(same(origin.file, file));
        take_all(copy.shared, RunId{1},
                 joined(messages_of_run(origin.file, RunId{1}, *copy.shared.position(RunId{1}))));
        CHECK(same(origin.file, file));
        CHECK(test::faults_of(file).empty());
        CHECK(*copy.shared.is_settled(RunId{1}, 1));
    }
}

TEST_CASE("a run that goes on is given as far as it was committed, and further the next time", "[cluster][R61]") {
    Published origin;
    Following copy{origin.folder / "copy.db", origin.identity};
    pipeline::Pipeline pipeline{origin.archive, followed_dictionary};
    REQUIRE(pipeline.begin({}));
    for (std::uint16_t count = 0; count < 100; ++count) {
        REQUIRE(pipeline.accept(test::navigation(count)));
        if (count == 60) continue;  // is not committed when it is asked for
        if (count % 20 == 19) REQUIRE(pipeline.commit());
        if (count % 40 != 1) continue;
        take_all(copy.shared, RunId{1},
                 joined(messages_of_run(origin.file, RunId{1}, *copy.shared.position(RunId{1}))));
        CHECK_FALSE(*copy.shared.is_settled(RunId{1}, 1));
    }
    REQUIRE(pipeline.finish({archive::Outcome::touchdown, "", "", ""}));
    take_all(copy.shared, RunId{1}, joined(messages_of_run(origin.file, RunId{1}, *copy.shared.position(RunId{1}))));
    CHECK(same(origin.file, origin.folder / "copy.db"));
}

TEST_CASE("a follower gives its runs as the origin's own, and says what it does not have", "[cluster][R61]") {
    Published origin;
    test::record_run(origin.archive, followed_dictionary, 300);
    const auto middle = origin.folder / "middle.db";
    Following first{middle, origin.identity};
    take_all(first.shared, RunId{1}, joined(messages_of_run(origin.file, RunId{1})));
    cluster::FramedMessages framed;
    framed.add(joined(messages_of_run(middle, RunId{1})));
    const auto message = framed.next();
    REQUIRE(message);
    CHECK((**message).archive() == origin.identity);
    CHECK((**message).run() == 1);
    v1::RunPosition beyond;
    beyond.set_seq(100'000);
    const auto error_of = [](const std::filesystem::path& file, RunId run, const v1::RunPosition& held) {
        const auto begun = RunSnapshot::begin(file, run, held);
        REQUIRE_FALSE(begun);
        return begun.error().message;
    };
    CHECK_THAT(error_of(middle, RunId{1}, beyond), Catch::Contains("not up to 100000"));
    CHECK_THAT(error_of(middle, RunId{2}, {}), Catch::Contains("run 2: there is none"));
    const auto alone = origin.folder / "alone.db";
    auto unpublished = Archive::open(alone);
    REQUIRE(unpublished);
    CHECK_THAT(error_of(alone, RunId{1}, {}), Catch::Contains("nobody follows this archive"));
}

TEST_CASE("messages are found in octets however they are cut, and other octets are refused", "[cluster][R61]") {
    Published origin;
    test::record_run(origin.archive, followed_dictionary, 300);
    const auto messages = messages_of_run(origin.file, RunId{1});
    cluster::FramedMessages one_by_one;
    std::size_t found = 0;
    for (const char octet : joined(messages)) {
        one_by_one.add({&octet, 1});
        const auto message = one_by_one.next();
        REQUIRE(message);
        if (*message) ++found;
        CHECK(one_by_one.within() != message->has_value());
    }
    CHECK(found == messages.size());
    for (const auto& octets : {std::string("\xff\xff\xff\xff", 4), std::string("\0\0\0\3abc", 7),
                               std::string("\0\0\0\0", 4), std::string{"<html>"}}) {
        cluster::FramedMessages foreign;
        foreign.add(octets);
        CHECK_FALSE(foreign.next());
    }
}

}  // namespace server_cluster_run_snapshot_test
