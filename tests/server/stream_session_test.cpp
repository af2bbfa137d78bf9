#include "server/net/stream_session.hpp"
#include "tests/support/catch.hpp"

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

/// The rest of the server as a stream sees it: an archive of items that answers when told to.
struct Venue {
    std::vector<v1::Item> durable;
    std::vector<std::function<void()>> waiting; ///< answers of the archive
    std::size_t pages_read = 0;
    StreamHub hub{4711, services()};

    StreamHub::Services services() {
        StreamHub::Services services;
        services.read_items = [this](archive::RunId, archive::Sequence after, std::size_t limit,
                                     archive::Reader::ItemKinds, const auto& done) {
            ++pages_read;
            archive::ItemPage page;
            for (const auto& item : durable)
                if (item.seq() > after && page.items.size() < limit) page.items.push_back(item);
            page.complete_through = page.items.empty() ? after : page.items.back().seq();
            page.more = page.complete_through < durable.size();
            waiting.push_back([done, page] { done(page); });
        };
        services.read_run = [](std::uint64_t run, const auto& done) { done(Error{"no run " + std::to_string(run)}); };
        services.want_items = [](bool) {};
        return services;
    }
    Venue() {
        v1::RunState state;
        state.set_run(1);
        state.set_state("running");
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
    void publish_events(std::size_t count) {
        std::vector<v1::Item> items;
        for (std::size_t i = 0; i < count; ++i)
            items.push_back(event_item(durable.size() + i + 1));
        publish(std::move(items));
    }
    void answer() {
        for (auto& each : std::exchange(waiting, {}))
            each();
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

    void subscribe(archive::Sequence after, double max_rate_hz = 0.0, bool all_channels = true) {
        v1::ClientMessage message;
        message.mutable_subscribe()->set_after_seq(after);
        message.mutable_subscribe()->set_all_channels(all_channels);
        message.mutable_subscribe()->set_max_rate_hz(max_rate_hz);
        session->on_message(message.SerializeAsString());
    }
    /// Writes out what is due, and keeps it.
    void read_all() {
        while (const auto encoded = session->next_message()) {
            v1::ServerMessage message;
            REQUIRE(message.ParseFromString(*encoded));
            if (message.has_batch()) {
                const auto& batch = message.batch();
                CHECK(batch.after_seq() == complete_through); // a chain without a hole
                complete_through = batch.complete_through();
                for (const auto& item : batch.items())
                    seen.push_back(item.seq());
            }
            if (message.has_refusal()) refusals.push_back(message.refusal().reason());
            messages.push_back(std::move(message));
        }
    }
    bool saw_exactly(archive::Sequence first, archive::Sequence last) const {
        std::vector<archive::Sequence> wanted;
        for (auto seq = first; seq <= last; ++seq)
            wanted.push_back(seq);
        return seen == wanted;
    }

    std::string refusal;
    std::shared_ptr<StreamSession> session;
    archive::Sequence complete_through = 0;
    std::vector<archive::Sequence> seen;
    std::vector<std::string> refusals;
    std::vector<v1::ServerMessage> messages;
};

} // namespace

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
    CHECK(venue.pages_read == 0); // all of it was still in memory
}

TEST_CASE("a slow client reads the archive and loses nothing", "[stream][R42]") {
    Venue venue;
    Client client{venue.hub};
    client.subscribe(0);
    venue.publish_events(10);
    client.read_all();
    for (int i = 0; i < 40; ++i)
        venue.publish_events(1000); // more than the hub holds, none of it read meanwhile
    while (client.complete_through < venue.durable.size()) {
        client.read_all();
        if (venue.waiting.empty()) break;
        venue.publish_events(1); // and it goes on
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
    for (std::size_t i = 0; i < 128; ++i) { // two seconds at 64 Hz, an event with each sample
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
    CHECK(thinned == 15); // the first leaves nothing out
    CHECK(events == 128);
    CHECK(client.complete_through == 256);
}

TEST_CASE("only the channels of the subscription are sent", "[stream]") {
    const auto item = samples_item(1, 5.0);
    const std::vector<ItemBefore> items{{&item, std::nullopt}};
    v1::Batch batch;
    select_items({StreamFormat::json, false, {speed}, 0.0}, 0.0, items, batch);
    REQUIRE(batch.items_size() == 1);
    CHECK(batch.items(0).samples().ids_size() == 1);
    CHECK(batch.items(0).samples().ids(0) == speed);
    batch.clear_items();
    select_items({StreamFormat::json, false, {99}, 0.0}, 0.0, items, batch);
    CHECK(batch.items_size() == 0);
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
    for (std::size_t i = 0; i <= StreamSession::replies_max; ++i)
        client.session->on_message("\xFF");
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
