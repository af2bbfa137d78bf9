// SPDX-License-Identifier: Apache-2.0
#include "server/api/stream_session.hpp"

#include "server/api/query_threads.hpp"
#include "server/base/json.hpp"
#include "tests/server/archive/faulty_disk.hpp"
#include "tests/server/small_mission.hpp"
#include "tests/support/catch.hpp"

#include <array>
#include <condition_variable>
#include <future>
#include <limits>
#include <map>
#include <mutex>
#include <random>

namespace server_stream_session_test {

using namespace aeolis;
using namespace aeolis::server;

namespace {

constexpr std::uint32_t altitude = 3, speed = 4;

v1::Item samples_item(archive::Sequence seq, double sclk, v1::Source source = v1::SOURCE_REALTIME) {
    v1::Item item;
    item.set_seq(seq);
    auto& samples = *item.mutable_samples();
    samples.set_sclk(sclk);
    samples.set_source(source);
    for (const auto id : {altitude, speed}) {
        samples.add_ids(id);
        samples.add_values(sclk);
    }
    return item;
}

v1::Item event_item(archive::Sequence seq) {
    v1::Item item;
    item.set_seq(seq);
    item.mutable_event()->set_name("E" + std::to_string(seq));
    return item;
}

/// What has reached Earth `ert_s` seconds after noon of 1 January 2000.
v1::Item event_item(archive::Sequence seq, double ert_s) {
    auto item = event_item(seq);
    item.set_ert_us(static_cast<std::int64_t>(ert_s * 1e6));
    return item;
}

/// The rest of the server as a stream sees it: an archive of items that answers when told to.
struct Venue {
    std::vector<v1::Item> durable;
    std::vector<v1::Item> flown;  ///< of the run flown_before; none: the same as of this one
    std::chrono::steady_clock::time_point now{};
    std::vector<std::function<void()>> waiting;  ///< answers of the archive
    std::size_t pages_read = 0;
    std::string broken;  ///< what the disk says instead; empty: it is well
    StreamHub hub{4711, services()};

    StreamHub::Services services() {
        StreamHub::Services services;
        services.read_items = [this](archive::RunId run, archive::Sequence after, std::size_t limit,
                                     archive::Reader::ItemKinds kinds, const auto& done) {
            ++pages_read;
            const auto& stored = items_of(run.value);
            if (!broken.empty()) return waiting.push_back([done, why = broken] { done(Error{why, true}); });
            archive::ItemPage page;
            for (const auto& item : stored)
                if (item.seq() > after && page.items.size() < limit && (kinds.packets || !item.has_unit()))
                    page.items.push_back(item);
            page.complete_through = page.items.size() < limit ? stored.size() : page.items.back().seq();
            page.more = page.complete_through < stored.size();
            waiting.push_back([done, page] { done(page); });
        };
        services.read_run = [this](std::uint64_t run, const auto& done) {
            if (!broken.empty()) return done(Error{broken, true});
            if (run != flown_before && run != 1) return done(Error{"no run " + std::to_string(run)});
            v1::RunState state;
            state.set_run(run);
            state.set_last_seq(items_of(run).size());
            done(state);
        };
        services.now = [this] { return now; };
        services.want_items = [](bool) {};
        services.channel_id = [](const std::string& name) -> Result<std::uint32_t> {
            if (name == "altitude_m" || name == "GNC-0001") return altitude;
            if (name == "speed_mps") return speed;
            return Error{"channel_names: there is no channel '" + name + "'"};
        };
        services.has_channel = [](std::uint32_t id) { return id < 1'000; };
        return services;
    }
    static constexpr std::uint64_t flown_before = 9;
    const std::vector<v1::Item>& items_of(std::uint64_t run) const {
        return run == flown_before && !flown.empty() ? flown : durable;
    }
    Venue() {
        v1::RunState state;
        state.set_run(1);
        state.set_state(v1::RunState::running);
        hub.run_state(state);
    }
    void publish(std::vector<v1::Item> items) {
        durable.insert(durable.end(), items.begin(), items.end());
        auto batch = std::make_shared<pipeline::PublishedBatch>();
        batch->run = archive::RunId{1};
        batch->first_seq = items.front().seq();
        batch->last_seq = items.back().seq();
        batch->items = std::move(items);
        hub.published(batch);
    }
    /// In the archive only: as when nobody followed.
    void store_events(std::size_t count) {
        auto batch = std::make_shared<pipeline::PublishedBatch>();
        batch->run = archive::RunId{1};
        batch->first_seq = durable.size() + 1;
        for (std::size_t i = 0; i < count; ++i) durable.push_back(event_item(durable.size() + 1));
        batch->last_seq = durable.size();
        batch->built = false;
        hub.published(batch);
    }
    void publish_events(std::size_t count) {
        std::vector<v1::Item> items;
        for (std::size_t i = 0; i < count; ++i) items.push_back(event_item(durable.size() + i + 1));
        publish(std::move(items));
    }
    void answer() {
        for (auto& each : std::exchange(waiting, {})) each();
    }
};

struct Client {
    explicit Client(StreamHub& hub, StreamFormat format = StreamFormat::protobuf)
        : session(std::make_shared<StreamSession>(hub, format, [] {}, rights())) {}

    StreamSession::Client rights() {
        auto client = StreamSession::follower();
        client.control = [](const v1::RehearsalControl&, const auto& done) { done(Error{"no rehearsal goes on"}); };
        client.refusal = [this] { return refusal; };
        return client;
    }

    void subscribe(archive::Sequence after, double max_rate_hz = 0.0, bool all_channels = true, std::uint64_t run = 0) {
        v1::ClientMessage message;
        message.mutable_subscribe()->set_run(run);
        message.mutable_subscribe()->set_after_seq(after);
        message.mutable_subscribe()->set_all_channels(all_channels);
        message.mutable_subscribe()->set_max_rate_hz(max_rate_hz);
        send(message);
    }
    void send(const v1::ClientMessage& message) const {
        session->on_message(session->format() == StreamFormat::json ? to_json(message) : message.SerializeAsString());
    }
    void replay(double pace, archive::Sequence after = 0, std::uint64_t run = Venue::flown_before) {
        v1::ClientMessage message;
        message.mutable_subscribe()->set_run(run);
        message.mutable_subscribe()->set_after_seq(after);
        message.mutable_subscribe()->set_all_channels(true);
        message.mutable_subscribe()->set_pace(pace);
        send(message);
        complete_through = after;
        seen.clear();
    }
    /// Writes out what is due, and keeps it.
    void read_all() {
        while (const auto encoded = session->next_message()) {
            v1::ServerMessage message;
            REQUIRE((session->format() == StreamFormat::json ? from_json(*encoded, message).ok()
                                                             : message.ParseFromString(*encoded)));
            if (message.has_batch()) {
                const auto& batch = message.batch();
                CHECK(batch.after_seq() == complete_through);  // a chain without a hole
                complete_through = batch.complete_through();
                for (const auto& item : batch.items()) seen.push_back(item.seq());
            }
            if (message.has_refusal()) refusals.push_back(message.refusal().reason());
            messages.push_back(std::move(message));
        }
    }
    bool saw_exactly(archive::Sequence first, archive::Sequence last) const {
        std::vector<archive::Sequence> wanted;
        for (auto seq = first; seq <= last; ++seq) wanted.push_back(seq);
        return seen == wanted;
    }

    std::string refusal;
    std::shared_ptr<StreamSession> session;
    archive::Sequence complete_through = 0;
    std::vector<archive::Sequence> seen;
    std::vector<std::string> refusals;
    std::vector<v1::ServerMessage> messages;
};

}  // namespace

TEST_CASE("a client gets nothing before it subscribes, then a welcome first", "[stream][R42]") {
    Venue venue;
    venue.publish_events(3);
    Client client{venue.hub};
    client.read_all();
    CHECK(client.messages.empty());
    client.subscribe(0);
    client.read_all();
    REQUIRE(client.messages.size() >= 2);
    CHECK(client.messages[0].welcome().last_seq() == 3);
    CHECK(client.messages[0].welcome().dictionary_id() == 4711);
    CHECK(client.saw_exactly(1, 3));
}

TEST_CASE("a client that resumes gets what it missed, each item once", "[stream][R42]") {
    Venue venue;
    venue.publish_events(100);
    Client client{venue.hub};
    client.complete_through = 40;
    client.subscribe(40);
    client.read_all();
    venue.publish_events(10);
    client.read_all();
    CHECK(client.saw_exactly(41, 110));
    CHECK(venue.pages_read == 0);  // all of it was still in memory
}

namespace {

/// A program that follows the run, is cut off and comes back, and holds what it was told against what was published.
struct Follower {
    Follower(Venue& its_venue, double its_rate_hz, bool all)
        : venue(its_venue), rate_hz(its_rate_hz), all_channels(all) {
        connect();
    }

    void connect() {
        client.emplace(venue.hub);
        client->complete_through = through;
        v1::ClientMessage message;
        auto& subscribe = *message.mutable_subscribe();
        subscribe.set_run(1);
        subscribe.set_after_seq(through);
        subscribe.set_all_channels(all_channels);
        if (!all_channels) subscribe.add_channels(altitude);
        subscribe.set_max_rate_hz(rate_hz);
        client->send(message);
        began = through;
    }
    void cut() { client.reset(); }

    void read() {
        if (!client) return;
        client->read_all();
        for (const auto& message : std::exchange(client->messages, {})) {
            const auto& batch = message.batch();
            for (const auto& item : batch.items()) take(item);
            if (!message.has_batch()) continue;
            through = batch.complete_through();
            left_out += batch.left_out();
            CHECK(got_count + left_out == selected_through(through));
        }
    }
    void take(const v1::Item& item) {
        if (!item.has_samples()) return;
        ++got_count;
        const auto& published = venue.durable[item.seq() - 1].samples();
        CHECK(item.samples().sclk() == published.sclk());
        CHECK(item.samples().ids_size() == (all_channels ? published.ids_size() : 1));
        // From the one before, in this subscription, to this one: was anything left out?
        const auto first = published.ids(0);
        auto before = item.seq() - 1;
        while (before > began && !(has(before) && venue.durable[before - 1].samples().ids(0) == first)) --before;
        const bool missing = before > began && before != last_of_packet[first];
        if (missing) CHECK(item.samples().thinned());
        if (rate_hz == 0.0) CHECK_FALSE(item.samples().thinned());
        last_of_packet[first] = item.seq();
    }
    bool has(archive::Sequence seq) const {
        const auto& ids = venue.durable[seq - 1].samples().ids();
        return !ids.empty() && (all_channels || std::ranges::find(ids, altitude) != ids.end());
    }
    std::uint64_t selected_through(archive::Sequence last) const {
        std::uint64_t count = 0;
        for (archive::Sequence seq = 1; seq <= last; ++seq) count += has(seq) ? 1 : 0;
        return count;
    }

    Venue& venue;
    double rate_hz;
    bool all_channels;
    std::optional<Client> client;
    archive::Sequence through = 0, began = 0;
    std::uint64_t got_count = 0, left_out = 0;
    std::map<std::uint32_t, archive::Sequence> last_of_packet;
};

/// Items of some moments: two packets with samples at 64 Hz and 4 Hz, and events.
std::vector<v1::Item> some_items(std::mt19937& random, archive::Sequence last, double& sclk) {
    std::vector<v1::Item> items;
    const auto count = 1 + random() % 60;
    for (std::size_t i = 0; i < count; ++i) {
        sclk += 1.0 / 64.0;
        items.push_back(samples_item(last + items.size() + 1, sclk));
        if (random() % 8 == 0) items.push_back(event_item(last + items.size() + 1));
        if (random() % 16 == 0) {
            items.push_back(samples_item(last + items.size() + 1, sclk));
            auto& samples = *items.back().mutable_samples();
            samples.clear_ids();
            samples.add_ids(9);
            samples.mutable_values()->Truncate(1);
        }
    }
    return items;
}

void publish_in_archive_only(Venue& venue, std::vector<v1::Item> items) {
    auto batch = std::make_shared<pipeline::PublishedBatch>();
    batch->run = archive::RunId{1};
    batch->first_seq = items.front().seq();
    batch->last_seq = items.back().seq();
    batch->built = false;
    venue.durable.insert(venue.durable.end(), items.begin(), items.end());
    venue.hub.published(batch);
}

}  // namespace

TEST_CASE("wherever clients are cut off, each gets every sample or the number of those that its rate left out",
          "[stream][R42][property]") {
    for (unsigned seed = 0; seed < 60; ++seed) {
        CAPTURE(seed);
        std::mt19937 random{seed};
        Venue venue;
        double sclk = 1000.0;
        std::vector<std::unique_ptr<Follower>> followers;
        const bool alone = seed % 3 == 0;  // nobody follows while it is cut off: then only the archive has the items
        const bool late = seed % 2 == 0;   // the network thread is: then some batches come without their items
        for (const double rate_hz : {0.0, 0.0, 20.0, 3.0}) {
            followers.push_back(std::make_unique<Follower>(venue, rate_hz, followers.size() % 2 == 0));
            if (alone) break;
        }
        const auto paces = std::array{1.0, 1.0, 30.0};
        for (int step = 0; step < 120; ++step) {
            if (random() % 10 == 0) {
                auto state = venue.hub.state();
                state.set_attained_pace(paces.at(random() % paces.size()));
                venue.hub.run_state(state);
            }
            auto items = some_items(random, venue.durable.size(), sclk);
            const bool watched =
                std::ranges::any_of(followers, [](const auto& each) { return each->client.has_value(); });
            if (watched && !(late && random() % 6 == 0))
                venue.publish(std::move(items));
            else
                publish_in_archive_only(venue, std::move(items));
            for (auto& each : followers) {
                if (random() % 12 == 0) each->cut();
                if (!each->client && random() % 3 == 0) each->connect();
                if (random() % 4 != 0) each->read();
            }
            if (random() % 3 == 0) venue.answer();
        }
        for (auto& each : followers) {
            if (!each->client) each->connect();
            do {
                venue.answer();
                each->read();
            } while (!venue.waiting.empty());
            venue.hub.clocks({});
            each->read();
            CHECK(each->through == venue.durable.size());
            if (each->rate_hz == 0.0) CHECK(each->left_out == 0);
        }
    }
}

TEST_CASE("behind a catch-up thinned further than the rate asked for, the first live sample of each packet says so",
          "[stream][R42]") {
    for (const double rate_hz : {20.0, 3.0, 0.5}) {
        CAPTURE(rate_hz);
        std::mt19937 random{7};
        Venue venue;
        double sclk = 1000.0;
        Follower one{venue, rate_hz, true}, other{venue, rate_hz, false};
        const auto publish = [&] { venue.publish(some_items(random, venue.durable.size(), sclk)); };
        publish();
        for (auto* each : {&one, &other}) each->read();  // both are live
        for (int round = 0; round < 3; ++round) {
            const auto behind = venue.durable.size() + StreamHub::items_max + 1'000;
            while (venue.durable.size() < behind) publish();
            const auto pages_before = venue.pages_read;
            for (int i = 0; i < 40; ++i) {
                venue.answer();
                if (i % 3 == 0) publish();  // the end of the pages falls anywhere
                for (auto* each : {&one, &other}) each->read();
            }
            CHECK(venue.pages_read > pages_before);
            CHECK(one.through == venue.durable.size());
        }
        CHECK(one.left_out > 0);
    }
}

TEST_CASE("a slow client reads the archive and loses nothing", "[stream][R42]") {
    Venue venue;
    Client client{venue.hub};
    client.subscribe(0);
    venue.publish_events(10);
    client.read_all();
    for (int i = 0; i < 40; ++i) venue.publish_events(1000);  // more than the hub holds, none of it read meanwhile
    while (client.complete_through < venue.durable.size()) {
        client.read_all();
        if (venue.waiting.empty()) break;
        venue.publish_events(1);  // and it goes on
        venue.answer();
    }
    client.read_all();
    CHECK(client.saw_exactly(1, venue.durable.size()));
    CHECK(venue.pages_read > 10);
    CHECK(client.refusals.empty());
}

TEST_CASE("clients that want the same share one encoding", "[stream]") {
    Venue venue;
    Client first{venue.hub}, second{venue.hub}, third{venue.hub, StreamFormat::json};
    first.subscribe(0);
    second.subscribe(0);
    venue.publish_events(5);
    first.read_all();
    const auto encodings = venue.hub.figures.encodings;
    second.read_all();
    CHECK(venue.hub.figures.encodings == encodings);
    CHECK(venue.hub.figures.shared == 1);
    CHECK(second.saw_exactly(1, 5));
}

TEST_CASE("samples are thinned to the rate asked for and say so; nothing else is", "[stream][R42]") {
    Venue venue;
    Client client{venue.hub};
    client.subscribe(0, 8.0);
    client.read_all();
    std::size_t samples = 0, thinned = 0, events = 0;
    for (std::size_t i = 0; i < 128; ++i) {  // two seconds at 64 Hz, an event with each sample
        const auto seq = venue.durable.size() + 1;
        venue.publish({samples_item(seq, 1000.0 + static_cast<double>(i) / 64.0), event_item(seq + 1)});
        client.read_all();
    }
    for (const auto& message : client.messages)
        for (const auto& item : message.batch().items()) {
            samples += item.has_samples() ? 1 : 0;
            thinned += item.samples().thinned() ? 1 : 0;
            events += item.has_event() ? 1 : 0;
        }
    CHECK(samples == 16);
    CHECK(thinned == 15);  // the first leaves nothing out
    CHECK(events == 128);
    CHECK(client.complete_through == 256);
}

TEST_CASE("only the channels of the subscription are sent", "[stream]") {
    auto item = samples_item(1, 5.0);
    item.set_ert_us(7);
    const std::vector<ItemWithFacts> items{{&item, {.ascend = true}}};
    v1::Batch batch;
    select_items({StreamFormat::json, false, {speed}, 0.0}, 0.0, items, batch);
    REQUIRE(batch.items_size() == 1);
    CHECK(batch.items(0).samples().ids_size() == 1);
    CHECK(batch.items(0).samples().ids(0) == speed);
    CHECK(batch.items(0).ert_us() == 7);
    batch.clear_items();
    select_items({StreamFormat::json, false, {99}, 0.0}, 0.0, items, batch);
    CHECK(batch.items_size() == 0);
}

TEST_CASE("a subscription names channels by name or alias, by id, or both, and those named twice count once",
          "[stream][R62]") {
    const std::vector<std::uint32_t> only_altitude{altitude}, both{altitude, speed};
    struct Wish {
        std::vector<std::string> names;
        std::vector<std::uint32_t> ids;
        const std::vector<std::uint32_t>& gets;
    };
    for (const auto format : {StreamFormat::protobuf, StreamFormat::json})
        for (const auto& wish :
             {Wish{{"altitude_m"}, {}, only_altitude}, Wish{{"speed_mps", "altitude_m"}, {}, both},
              Wish{{"speed_mps"}, {altitude}, both}, Wish{{"GNC-0001", "altitude_m"}, {altitude}, only_altitude}}) {
            Venue venue;
            Client client{venue.hub, format};
            v1::ClientMessage message;
            for (const auto& name : wish.names) message.mutable_subscribe()->add_channel_names(name);
            for (const auto id : wish.ids) message.mutable_subscribe()->add_channels(id);
            client.send(message);
            venue.publish({samples_item(1, 5.0)});
            client.read_all();
            INFO(wish.names.front() << " and " << wish.ids.size() << " ids");
            CHECK(client.refusals.empty());
            REQUIRE(client.saw_exactly(1, 1));
            const auto& ids = client.messages.back().batch().items(0).samples().ids();
            CHECK(std::vector<std::uint32_t>(ids.begin(), ids.end()) == wish.gets);
        }
}

TEST_CASE("a subscription with a name or an id that is no channel is refused by it, and the one before stands",
          "[stream][bounds][R62]") {
    Venue venue;
    Client client{venue.hub};
    v1::ClientMessage message;
    message.mutable_subscribe()->add_channel_names("altitude_m");
    client.send(message);
    message.mutable_subscribe()->add_channel_names("moon_phase");
    client.send(message);
    message.mutable_subscribe()->clear_channel_names();
    for (int i = 0; i < 4'097; ++i) message.mutable_subscribe()->add_channel_names("altitude_m");
    client.send(message);
    message.mutable_subscribe()->clear_channel_names();
    message.mutable_subscribe()->add_channel_names(std::string(60'000, 'x'));
    client.send(message);
    message.mutable_subscribe()->clear_channel_names();
    message.mutable_subscribe()->add_channels(1);
    message.mutable_subscribe()->add_channels(9'999);
    client.send(message);
    venue.publish({samples_item(1, 5.0)});
    client.read_all();
    REQUIRE(client.refusals.size() == 4);
    CHECK(client.refusals[3] == "channels: there is no channel with the id 9999");
    CHECK(client.refusals[2] == "channel_names: one of 60000 octets is no name of a channel");
    CHECK(client.refusals[0] == "channel_names: there is no channel 'moon_phase'");
    CHECK_THAT(client.refusals[1], Catch::Contains("channel_names: 4097 of them, at most 4096"));
    REQUIRE(client.saw_exactly(1, 1));
    CHECK(client.messages.back().batch().items(0).samples().ids_size() == 1);
}

TEST_CASE("packets that share their header's channels have a rate each; another mission's rate counts by reception, "
          "because its clock may stand still",
          "[server][stream][downlink][R54]") {
    std::vector<v1::Item> items;
    for (int i = 0; i < 10; ++i)
        for (const std::uint32_t own : {1U, 2U}) {
            v1::Item& item = items.emplace_back();
            item.set_seq(items.size());
            item.set_ert_us(60'000 * i);
            item.mutable_samples()->set_sclk(1000.0);
            item.mutable_samples()->set_source(v1::SOURCE_REALTIME);
            for (const std::uint32_t id : {0U, own}) {
                item.mutable_samples()->add_ids(id);
                item.mutable_samples()->add_values(i);
            }
        }
    const auto given = [&](RateBy by) {
        SampleSpacing spacing{true, by};
        std::vector<ItemWithFacts> with_facts;
        for (const auto& item : items) with_facts.push_back({&item, spacing.next(item)});
        v1::Batch batch;
        select_items({StreamFormat::json, true, {}, 20.0}, 0.05, with_facts, batch);
        CHECK(batch.items_size() + static_cast<int>(batch.left_out()) == 20);
        return batch.items_size();
    };
    CHECK(given(RateBy::vehicle) == 2);
    CHECK(given(RateBy::reception) == 20);
}

TEST_CASE("channels that ascend are found as those that do not", "[stream]") {
    std::mt19937 random{7};
    for (int round = 0; round < 300; ++round) {
        v1::Item item;
        item.set_seq(1);
        std::vector<std::uint32_t> wanted;
        for (std::uint32_t id = 0; id < 60; ++id) {
            if (random() % 3 == 0) {
                item.mutable_samples()->add_ids(id);
                item.mutable_samples()->add_values(id * 0.5);
            }
            if (random() % (1 + round % 20) == 0) wanted.push_back(id);
        }
        if (!item.has_samples()) continue;
        const auto chosen = [&](bool ascend) {
            v1::Batch batch;
            select_items({StreamFormat::json, false, wanted, 0.0}, 0.0,
                         std::vector<ItemWithFacts>{{&item, {.ascend = ascend}}}, batch);
            return batch.SerializeAsString();
        };
        CHECK(chosen(true) == chosen(false));
    }
}

TEST_CASE("a client that wants nothing of what came last is told with the run's state that all of it is there",
          "[stream][R42]") {
    Venue venue;
    Client client{venue.hub};
    client.subscribe(0, 0.0, false);
    venue.publish_events(2);
    client.read_all();
    CHECK(client.complete_through == 2);
    venue.publish({samples_item(3, 1.0), samples_item(4, 2.0)});  // of channels that it does not follow
    client.read_all();
    CHECK(client.complete_through == 2);  // a message for each group of these would cost more than it says
    v1::RunState over;
    over.set_run(1);
    over.set_state(v1::RunState::finished);
    venue.hub.run_state(over);  // of a mission that is followed no clocks come
    client.read_all();
    CHECK(client.complete_through == 4);
    CHECK(client.seen == std::vector<archive::Sequence>{1, 2});
}

TEST_CASE("what a client asks and cannot have is refused in words, and it goes on", "[stream]") {
    Venue venue;
    Client client{venue.hub};
    client.session->on_message("\xFF\xFF\xFFnonsense");
    client.session->on_message("");
    v1::ClientMessage message;
    message.mutable_subscribe()->set_run(77);
    client.session->on_message(message.SerializeAsString());
    message.mutable_subscribe()->set_run(1ULL << 40);
    client.session->on_message(message.SerializeAsString());
    message.mutable_control()->set_pause(true);
    client.session->on_message(message.SerializeAsString());
    client.subscribe(0, -1.0);
    client.read_all();
    REQUIRE(client.refusals.size() == 6);
    CHECK_THAT(client.refusals[0], Catch::Contains("not a ClientMessage"));
    CHECK_THAT(client.refusals[1], Catch::Contains("says nothing"));
    CHECK(client.refusals[2] == "no run 77");
    CHECK_THAT(client.refusals[3], Catch::Contains("there is none"));
    CHECK(client.refusals[4] == "no rehearsal goes on");
    CHECK_THAT(client.refusals[5], Catch::Contains("max_rate_hz: -1"));
    client.subscribe(0);
    client.read_all();
    CHECK(client.messages.back().has_welcome());
}

TEST_CASE("a client that asks and never reads is marked to be closed", "[stream]") {
    Venue venue;
    Client client{venue.hub};
    for (std::size_t i = 0; i <= StreamSession::replies_max; ++i) client.session->on_message("\xFF");
    CHECK_THAT(client.session->closing(), Catch::Contains("without reading"));
}

TEST_CASE("a client whose log-in has ended is told nothing more and is marked to be closed", "[stream][access]") {
    Venue venue;
    Client client{venue.hub};
    venue.publish_events(2);
    client.subscribe(0);
    client.read_all();
    CHECK(client.session->closing().empty());
    client.refusal = "the log-in has ended";
    venue.publish_events(2);
    venue.hub.check_clients();
    CHECK(client.session->next_message() == nullptr);
    CHECK(client.session->closing() == "the log-in has ended");
}

TEST_CASE("a client of the newest run is moved to the next one", "[stream]") {
    Venue venue;
    venue.publish_events(3);
    Client client{venue.hub};
    client.subscribe(0);
    client.read_all();
    v1::RunState next;
    next.set_run(2);
    venue.hub.run_state(next);
    client.complete_through = 0;
    client.read_all();
    CHECK(client.messages.back().welcome().run_state().run() == 2);
}

namespace {

/// The run that goes on ends, and another begins, before anyone reads.
void next_run(Venue& venue) {
    auto over = venue.hub.state();
    over.set_state(v1::RunState::finished);
    venue.hub.run_state(over);
    v1::RunState next;
    next.set_run(2);
    venue.hub.run_state(next);
}

}  // namespace

TEST_CASE("the clocks of the run before are not those of the next, which has its own or none yet", "[stream]") {
    Venue venue;
    v1::Clocks clocks;
    clocks.set_ert_us(5);
    venue.hub.clocks(clocks);
    CHECK(venue.hub.ert_now() == Ert{5});
    v1::RunState next;
    next.set_run(2);
    venue.hub.run_state(next);
    CHECK_FALSE(venue.hub.ert_now());  // no note of this run is of an instant of the other
    next.set_run(3);
    next.mutable_clocks()->set_ert_us(7);
    venue.hub.run_state(next);
    CHECK(venue.hub.ert_now() == Ert{7});
}

TEST_CASE("who is behind when the next run begins gets the rest of the one before, and then the next",
          "[stream][R42]") {
    Venue venue;
    venue.publish_events(5'000);  // more than two pages
    Client client{venue.hub};
    client.subscribe(0);
    REQUIRE(client.session->next_message());  // the welcome; then it stalls
    next_run(venue);
    for (int i = 0; i < 8; ++i) {
        client.read_all();
        venue.answer();
    }
    CHECK(client.saw_exactly(1, 5'000));
    CHECK(client.messages.back().welcome().run_state().run() == 2);
    CHECK(client.refusals.empty());
    CHECK_FALSE(client.session->behind());
}

TEST_CASE("how a run ended is told also when the next one begins in the same turn", "[stream][R42]") {
    Venue venue;
    venue.publish_events(3);
    Client client{venue.hub};
    client.subscribe(0);
    client.read_all();
    next_run(venue);
    client.read_all();
    REQUIRE(client.messages.size() >= 2);
    const auto& before = client.messages[client.messages.size() - 2].run_state();
    CHECK(before.run() == 1);
    CHECK(before.state() == v1::RunState::finished);
    CHECK(before.last_seq() == 3);
    CHECK(client.messages.back().welcome().run_state().run() == 2);
    CHECK(venue.pages_read == 0);
}

TEST_CASE("one question of a client is with the archive at a time, however often it subscribes", "[stream][bounds]") {
    Venue venue;
    venue.store_events(100);
    Client client{venue.hub};
    for (int i = 0; i < 1'000; ++i) {
        client.subscribe(static_cast<archive::Sequence>(i % 50), 0.0, true, 1);
        while (client.session->next_message()) {
        }
    }
    CHECK(venue.pages_read == 1);
    CHECK(venue.waiting.size() == 1);
    venue.answer();
    CHECK(venue.pages_read == 2);  // what the last subscription wants
    client.complete_through = 999 % 50;
    venue.answer();
    client.read_all();
    CHECK(client.saw_exactly(999 % 50 + 1, 100));
}

TEST_CASE(
    "what the archive does not give is told once, comes when it can be read again, and until then nothing looks live",
    "[stream][disk][R42]") {
    Venue venue;
    venue.store_events(100);
    Client client{venue.hub};
    venue.broken = "a.db: disk I/O error";
    client.subscribe(0);
    for (int i = 0; i < 5; ++i) {
        client.read_all();
        venue.answer();
        venue.hub.clocks({});
        venue.publish_events(1);
        client.read_all();
        venue.hub.check_clients();
    }
    REQUIRE(client.refusals.size() == 1);
    CHECK_THAT(client.refusals[0], Catch::Contains("tried again") && Catch::Contains("disk I/O error"));
    CHECK(std::ranges::any_of(client.messages, [](const auto& message) { return message.refusal().goes_on(); }));
    CHECK(venue.pages_read == 6);  // a check each, and no more than that
    CHECK(client.seen.empty());
    CHECK(std::ranges::none_of(client.messages,
                               [](const auto& message) { return message.has_batch(); }));  // and no clocks
    venue.broken.clear();
    venue.answer();
    venue.hub.check_clients();
    venue.answer();
    client.read_all();
    CHECK(client.saw_exactly(1, 105));
    CHECK(client.refusals.size() == 1);

    venue.broken = "a.db: disk I/O error";
    venue.store_events(10);
    client.read_all();
    venue.answer();
    client.read_all();
    CHECK(client.refusals.size() == 2);  // another time, and said again
    venue.broken.clear();
    venue.hub.check_clients();
    venue.answer();
    client.read_all();
    CHECK(client.saw_exactly(1, 115));
}

TEST_CASE("an older run that the archive does not give at once is followed when it does", "[stream][disk]") {
    Venue venue;
    venue.publish_events(20);
    Client client{venue.hub};
    venue.broken = "a.db: disk I/O error";
    client.subscribe(0, 0.0, true, Venue::flown_before);
    venue.hub.check_clients();
    client.read_all();
    CHECK(client.refusals.size() == 1);
    venue.broken.clear();
    venue.hub.check_clients();
    client.read_all();
    venue.answer();
    client.read_all();
    CHECK(client.saw_exactly(1, 20));

    venue.broken = "a.db: disk I/O error";  // who asks for another run meanwhile does not wait for this one
    client.subscribe(0, 0.0, true, Venue::flown_before);
    client.seen.clear();
    client.complete_through = 0;
    client.subscribe(0);
    client.read_all();
    CHECK(client.saw_exactly(1, 20));
}

namespace {

using namespace std::chrono_literals;

/// So much later; meanwhile the archive answers, and each connection writes when its timer says so.
void pass(Venue& venue, std::chrono::milliseconds wall, const std::vector<Client*>& clients) {
    const auto end = venue.now + wall;
    for (;;) {
        do {
            venue.answer();
            for (auto* client : clients) client->read_all();
        } while (!venue.waiting.empty());
        auto next = end;
        for (const auto* client : clients)
            if (const auto due = client->session->due()) next = std::min(next, *due);
        if (venue.now == end) return;
        REQUIRE(next > venue.now);  // a timer that has run out and brings nothing would spin
        venue.now = next;
    }
}

std::size_t batches(const Client& client) {
    return static_cast<std::size_t>(
        std::ranges::count_if(client.messages, [](const auto& message) { return message.has_batch(); }));
}

}  // namespace

TEST_CASE("a run that is over comes again at the pace asked for, each item when it would have reached Earth",
          "[stream][R42]") {
    Venue venue;
    v1::Item tone, stage, link, explanation;
    tone.set_seq(3);
    tone.mutable_tone();
    tone.set_ert_us(30'000'000);
    explanation.set_seq(4);
    explanation.set_ert_us(30'000'000);
    explanation.mutable_explanation()->set_text("because");
    stage.set_seq(5);
    stage.mutable_command_stage();
    stage.set_ert_us(25'000'000);  // before the tone was whole
    link.set_seq(6);
    link.mutable_link();
    link.set_ert_us(3'600'000'000);  // an hour of cruise
    venue.flown = {event_item(1, 0.0), samples_item(2, 5.0), tone, explanation, stage, link};
    Client client{venue.hub};
    client.replay(10.0);
    pass(venue, 0ms, {&client});
    CHECK(client.messages.front().welcome().last_seq() == 6);
    CHECK(client.saw_exactly(1, 2));
    CHECK(client.complete_through == 2);
    pass(venue, 2'999ms, {&client});
    CHECK(client.saw_exactly(1, 2));
    CHECK_FALSE(client.session->behind());
    pass(venue, 1ms, {&client});
    CHECK(client.saw_exactly(1, 5));
    CHECK(client.complete_through == 5);
    pass(venue, 356'999ms, {&client});
    CHECK(client.complete_through == 5);
    CHECK_FALSE(client.session->behind());
    pass(venue, 1ms, {&client});
    CHECK(client.saw_exactly(1, 6));
    CHECK_FALSE(client.session->due());
    CHECK_FALSE(client.session->behind());
    for (const auto& message : client.messages) CHECK((!message.has_batch() || message.batch().history()));
}

TEST_CASE("who replays gets twenty batches a second at most, over as many pages as it takes", "[stream][bounds]") {
    Venue venue;
    constexpr std::size_t items = 3 * StreamSession::page_items;
    for (std::size_t i = 0; i < items; ++i) venue.flown.push_back(event_item(i + 1, 0.001 * static_cast<double>(i)));
    Client client{venue.hub};
    client.replay(1.0);
    pass(venue, 1s, {&client});
    CHECK(client.seen.size() >= 951);  // what is due goes with the next batch
    CHECK(client.seen.size() <= 1'001);
    CHECK(batches(client) >= 20);
    CHECK(batches(client) <= 21);
    pass(venue, 6s, {&client});
    CHECK(client.saw_exactly(1, items));
    CHECK(batches(client) <= 1 + items / 50 + venue.pages_read);
}

TEST_CASE("of JSON a page of the past goes out in parts, each once, so that no message holds the network up",
          "[stream][bounds]") {
    Venue venue;
    constexpr std::size_t items = StreamSession::page_items + 3 * StreamSession::json_items / 2;
    venue.store_events(items);
    Client client{venue.hub, StreamFormat::json};
    client.subscribe(0);
    for (std::size_t page = 0; page < 3; ++page) {
        client.read_all();
        venue.answer();
    }
    client.read_all();
    CHECK(client.saw_exactly(1, items));
    CHECK(venue.pages_read == 2);
    for (const auto& message : client.messages)
        CHECK(message.batch().items_size() <= static_cast<int>(StreamSession::json_items));
}

TEST_CASE(
    "each replays at a pace of its own and from its own place, and who follows the run that goes on does not notice",
    "[stream][R42]") {
    Venue venue;
    for (int i = 0; i < 100; ++i) venue.flown.push_back(event_item(static_cast<archive::Sequence>(i) + 1, i));
    Client slow{venue.hub}, fast{venue.hub}, live{venue.hub};
    live.subscribe(0);
    slow.replay(1.0, 50);  // its time counts from item 51 on
    fast.replay(20.0);
    slow.complete_through = 50;
    for (archive::Sequence second = 1; second <= 4; ++second) {
        venue.publish_events(10);
        pass(venue, 1s, {&slow, &fast, &live});
        CHECK(slow.saw_exactly(51, 51 + second));
        CHECK(fast.saw_exactly(1, 1 + 20 * second));
        CHECK(live.saw_exactly(1, 10 * second));
        CHECK_FALSE(live.session->due());
        CHECK(venue.hub.sessions_behind() == 0);
    }
}

TEST_CASE("a new subscription changes the pace of a replay, or where it is", "[stream][R42]") {
    Venue venue;
    for (int i = 0; i < 1'000; ++i) venue.flown.push_back(event_item(static_cast<archive::Sequence>(i) + 1, i));
    Client client{venue.hub};
    client.replay(1.0);
    pass(venue, 10s, {&client});
    CHECK(client.saw_exactly(1, 11));
    client.replay(100.0, client.complete_through);
    CHECK_FALSE(client.session->due());  // the archive is asked first
    pass(venue, 1s, {&client});
    CHECK(client.saw_exactly(12, 112));  // the eleventh second is not waited for again
    client.replay(1.0, 900);
    pass(venue, 2s, {&client});
    CHECK(client.saw_exactly(901, 903));
    client.replay(0.0, 903);
    pass(venue, 0s, {&client});
    CHECK(client.saw_exactly(904, 1'000));  // without a pace as fast as it is read
    client.replay(1e-300);
    pass(venue, 24h, {&client});
    CHECK(client.saw_exactly(1, 1));
    CHECK(client.refusals.empty());
}

TEST_CASE("a pace that is none, or for a run that goes on, is refused, and what was subscribed before goes on",
          "[stream]") {
    Venue venue;
    venue.publish_events(3);
    venue.flown = {event_item(1, 0.0), event_item(2, 1.0)};
    Client client{venue.hub};
    client.replay(1.0);
    pass(venue, 0ms, {&client});
    client.replay(std::numeric_limits<double>::infinity());
    client.replay(std::numeric_limits<double>::quiet_NaN());
    client.replay(-1.0);
    client.replay(10'000.5);
    client.replay(1.0, 0, 1);
    client.replay(1.0, 0, 0);
    client.complete_through = 1;
    pass(venue, 1s, {&client});
    REQUIRE(client.refusals.size() == 6);
    CHECK(client.refusals[2] == "pace: -1 is none: above 0 and up to 10000 is wanted, or 0 for as fast as it goes");
    CHECK_THAT(client.refusals[0], Catch::StartsWith("pace: inf"));
    CHECK_THAT(client.refusals[1], Catch::StartsWith("pace: nan"));
    CHECK_THAT(client.refusals[3], Catch::StartsWith("pace: 10000.5"));
    CHECK(client.refusals[4] ==
          "pace: it is for a run that is over, and run 1 goes on: name another, or follow this one without a pace");
    CHECK(client.refusals[5] == client.refusals[4]);
    CHECK(client.seen == std::vector<archive::Sequence>{2});
    client.replay(10'000.0);
    pass(venue, 1ms, {&client});
    CHECK(client.refusals.size() == 6);

    StreamHub none{1, venue.services()};
    Client first{none};
    first.replay(1.0, 0, 0);
    first.read_all();
    CHECK(first.refusals == std::vector<std::string>{"pace: it is for a run that is over, and there is none yet"});
}

TEST_CASE("the newest run is sent again at a pace when it is over, to its end, also when another begins",
          "[stream][R42]") {
    Venue venue;
    venue.publish({event_item(1, 0.0), event_item(2, 1.0), event_item(3, 2.0)});
    v1::RunState state;
    state.set_run(1);
    state.set_state(v1::RunState::finished);
    venue.hub.run_state(state);
    Client client{venue.hub};
    client.replay(1.0, 0, 0);
    pass(venue, 1s, {&client});
    CHECK(client.saw_exactly(1, 2));
    state.set_run(2);
    state.set_state(v1::RunState::running);
    venue.hub.run_state(state);
    pass(venue, 1s, {&client});
    CHECK(client.saw_exactly(1, 3));
    REQUIRE(client.messages.front().has_welcome());
    CHECK(client.messages.front().welcome().run_state().state() == v1::RunState::finished);
    CHECK(client.messages.front().welcome().last_seq() == 3);
    CHECK(batches(client) == client.messages.size() - 1);  // nothing of the other run
}

TEST_CASE("who replays and does not read gets all samples when it does, and is behind meanwhile", "[stream][R42]") {
    Venue venue;
    for (int second = 0; second < 10;
         ++second) {  // samples come in a packet, whose receipt this client does not ask for
        const auto seq = venue.flown.size() + 1;
        auto& packet = venue.flown.emplace_back();
        packet.set_seq(seq);
        packet.mutable_unit();
        packet.set_ert_us(second * 1'000'000);
        for (archive::Sequence i = 1; i <= 8; ++i)
            venue.flown.push_back(samples_item(seq + i, second + 0.125 * static_cast<double>(i)));
    }
    Client client{venue.hub};
    v1::ClientMessage message;
    auto& subscribe = *message.mutable_subscribe();
    subscribe.set_run(Venue::flown_before);
    subscribe.set_all_channels(true);
    subscribe.set_without_units(true);
    subscribe.set_pace(1.0);
    client.session->on_message(message.SerializeAsString());
    pass(venue, 1s, {&client});
    CHECK(client.seen.size() == 16);
    CHECK_FALSE(client.session->behind());
    venue.now += 5s;
    CHECK(client.session->behind());
    CHECK(venue.hub.sessions_behind() == 1);
    client.read_all();
    CHECK(client.seen.size() == 56);  // two seconds' and five more
    CHECK(batches(client) == 3);
    CHECK_FALSE(client.session->behind());
    for (const auto& told : client.messages)
        for (const auto& item : told.batch().items()) {
            CHECK(item.has_samples());
            CHECK_FALSE(item.samples().thinned());
        }
    pass(venue, 3s, {&client});
    CHECK(client.seen.size() == 80);
    CHECK(client.complete_through == venue.flown.size());
}

namespace {

/// A stream over a real archive and real query threads; the test is the network thread.
struct ArchivedStream {
    test::TemporaryFolder folder;
    dictionary::Dictionary dictionary = test::small_dictionary();
    std::filesystem::path file = folder / "a.db";
    archive::Sequence last = 0;
    std::mutex mutex;
    std::condition_variable posted;
    std::deque<std::function<void()>> posts;
    std::unique_ptr<StreamHub> hub;
    std::unique_ptr<QueryThreads> queries;  ///< ends first: until then it posts

    explicit ArchivedStream(std::uint16_t packets) {
        {
            auto archive = std::move(archive::Archive::open(file)).value();
            pipeline::Pipeline pipeline{archive, dictionary};
            pipeline.on_publish([&](const auto& batch) { last = batch->last_seq; });
            REQUIRE(pipeline.begin({}).ok());
            for (std::uint16_t i = 0; i < packets; ++i)
                REQUIRE(pipeline.accept(test::live(test::navigation_packet(i, 1000.0 + i, 9000.0F, 3.0F))).ok());
            REQUIRE(pipeline.commit().ok());
        }
        queries = std::move(QueryThreads::open(file, dictionary)).value();
        StreamHub::Services services;
        services.read_items = [this](archive::RunId run, archive::Sequence after, std::size_t limit,
                                     archive::Reader::ItemKinds kinds, const auto& done) {
            const bool taken = queries->ask(
                [=, this](archive::Reader& reader) {
                    post([done, page = reader.items(run, after, limit, kinds)] { done(page); });
                },
                {}, JobPriority::soon);
            if (!taken) post([done] { done(Error{QueryThreads::busy, true}); });
        };
        services.want_items = [](bool) {};
        hub = std::make_unique<StreamHub>(std::uint16_t{1}, services);
        v1::RunState state;
        state.set_run(1);
        state.set_last_seq(last);
        hub->run_state(state);
    }
    void post(std::function<void()> action) {
        const std::scoped_lock lock{mutex};
        posts.push_back(std::move(action));
        posted.notify_one();
    }
    /// Does what is posted, until `over` or for half a minute.
    void work_until(const std::function<bool()>& over) {
        const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds{30};
        while (!over() && std::chrono::steady_clock::now() < deadline) {
            std::unique_lock lock{mutex};
            if (!posted.wait_for(lock, std::chrono::seconds{1}, [&] { return !posts.empty(); })) {
                lock.unlock();
                hub->check_clients();  // once a second, as the server does
                continue;
            }
            const auto action = std::move(posts.front());
            posts.pop_front();
            lock.unlock();
            action();
        }
    }
};

}  // namespace

TEST_CASE("a thousand clients that come back at once all get what they missed, though both question threads are busy",
          "[stream][bounds][R42]") {
    ArchivedStream stream{100};
    std::promise<void> answered;
    const auto waits = answered.get_future().share();
    for (std::size_t i = 0; i < QueryThreads::question_threads; ++i)
        REQUIRE(stream.queries->ask([waits](archive::Reader&) { waits.wait(); }));
    std::vector<std::unique_ptr<Client>> clients;
    for (int i = 0; i < 1'000; ++i) {
        clients.push_back(std::make_unique<Client>(*stream.hub));
        clients.back()->subscribe(0);
        clients.back()->read_all();
    }
    stream.work_until([&] {
        for (auto& client : clients) client->read_all();
        return std::ranges::all_of(clients,
                                   [&](const auto& client) { return client->complete_through == stream.last; });
    });
    std::size_t whole = 0, refusals = 0;
    for (const auto& client : clients) {
        whole += client->saw_exactly(1, stream.last) ? 1 : 0;
        refusals += client->refusals.size();
    }
    CHECK(whole == 1'000);
    CHECK(refusals == 0);
    answered.set_value();
}

TEST_CASE("a disk that fails once stops no client's stream", "[stream][disk][R42]") {
    test::FaultyDisk disk;
    ArchivedStream stream{100};
    Client client{*stream.hub};
    disk.fail_at(1, test::FaultyDisk::Fault::input_output, false);
    client.subscribe(0);
    client.read_all();
    stream.work_until([&] {
        client.read_all();
        return client.complete_through == stream.last;
    });
    CHECK(disk.failed() == 1);
    CHECK(client.refusals.size() == 1);
    CHECK(client.saw_exactly(1, stream.last));
}

}  // namespace server_stream_session_test
