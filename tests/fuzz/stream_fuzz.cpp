// SPDX-License-Identifier: Apache-2.0
// What a client of the stream may send, in both subprotocols, while items are published: each batch joins the one
// before, no event is left out, and the session holds no more than it says. The first octet chooses the subprotocol; a
// message is preceded by its length in two octets.
#include "server/api/stream_session.hpp"
#include "server/base/json.hpp"

#include <cstdlib>
#include <google/protobuf/stubs/logging.h>

namespace {

using namespace aeolis;
using namespace aeolis::server;

constexpr archive::Sequence items_at_first = 40, items_a_message = 4;

void must(bool holds) {
    if (!holds) std::abort();
}

/// Events have even numbers, samples odd ones.
v1::Item item(archive::Sequence seq) {
    v1::Item made;
    made.set_seq(seq);
    if (seq % 2 == 0) {
        made.mutable_event()->set_name("E");
        return made;
    }
    auto& samples = *made.mutable_samples();
    samples.set_sclk(static_cast<double>(seq) / 64.0);
    samples.set_source(v1::SOURCE_REALTIME);
    for (const std::uint32_t channel : {1U, 7U}) {
        samples.add_ids(channel);
        samples.add_values(0.5);
    }
    return made;
}

/// The run that goes on; an archive that has all of it, and an older run that it has not.
struct Ground {
    StreamHub hub{1, services()};
    archive::Sequence last = 0;
    std::vector<std::function<void()>> answers;
    std::size_t replies_due = 0;

    Ground() {
        v1::RunState state;
        state.set_run(1);
        hub.run_state(state);
        publish(items_at_first / 2, false);  // the hub does not hold these
        publish(items_at_first / 2, true);
    }
    StreamHub::Services services() {
        StreamHub::Services services;
        services.read_items = [this](archive::RunId run, archive::Sequence after, std::size_t limit,
                                     archive::Reader::ItemKinds, const auto& done) {
            must(run.value == 1 && limit > 0);
            archive::ItemPage page;
            for (auto seq = after + 1; seq <= last && page.items.size() < limit; ++seq) page.items.push_back(item(seq));
            page.complete_through = page.items.empty() ? after : page.items.back().seq();
            page.more = page.complete_through < last;
            answers.push_back([done, page] { done(page); });
        };
        services.read_run = [](std::uint64_t run, const auto& done) { done(Error{"no run " + std::to_string(run)}); };
        services.want_items = [](bool) {};
        services.channel_id = [](const std::string& name) -> Result<std::uint32_t> {
            if (name.empty()) return Error{"channel_names: an empty one"};
            return static_cast<std::uint32_t>(name.size());
        };
        return services;
    }
    void publish(std::size_t count, bool built) {
        auto batch = std::make_shared<pipeline::PublishedBatch>();
        batch->run = archive::RunId{1};
        batch->first_seq = last + 1;
        batch->last_seq = last + count;
        batch->built = built;
        for (std::size_t i = 0; i < count && built; ++i) batch->items.push_back(item(batch->first_seq + i));
        last = batch->last_seq;
        hub.published(batch);
    }
};

struct Client {
    std::shared_ptr<StreamSession> session;
    archive::Sequence through = 0, last_event = 0;
    bool welcomed = false;

    void take(const v1::ServerMessage& message, archive::Sequence asked_after) {
        if (message.has_welcome()) {
            welcomed = true;
            through = asked_after;
            last_event = through / 2 * 2;
        }
        if (!message.has_batch()) return;
        const auto& batch = message.batch();
        must(welcomed && batch.after_seq() == through && batch.complete_through() >= through);
        archive::Sequence before = through;
        for (const auto& each : batch.items()) {
            must(each.seq() > before && each.seq() <= batch.complete_through());
            before = each.seq();
            if (!each.has_event()) continue;
            must(each.seq() == last_event + 2);
            last_event = each.seq();
        }
        through = batch.complete_through();
        must(last_event == through / 2 * 2);
    }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) return 0;
    google::protobuf::SetLogHandler(nullptr);  // as the server has it
    const auto format = data[0] % 2 == 0 ? StreamFormat::protobuf : StreamFormat::json;
    Ground ground;
    Client client{std::make_shared<StreamSession>(ground.hub, format, [] {}, StreamSession::follower())};
    archive::Sequence after = 0;
    const auto drain = [&] {
        for (;;) {
            while (const auto payload = client.session->next_message()) {
                v1::ServerMessage message;
                must(format == StreamFormat::json ? from_json(*payload, message).ok()
                                                  : message.ParseFromString(*payload));
                client.take(message, after);
            }
            if (ground.answers.empty()) return;
            for (const auto& answer : std::exchange(ground.answers, {})) answer();
        }
    };
    for (std::size_t at = 1; at + 2 <= size;) {
        const std::size_t length = std::min<std::size_t>(data[at] * 256U + data[at + 1], size - at - 2);
        const std::string_view payload{reinterpret_cast<const char*>(data) + at + 2, length};
        at += 2 + length;
        v1::ClientMessage asked;
        const bool parsed = format == StreamFormat::json
                                ? from_json(payload, asked).ok()
                                : asked.ParseFromArray(payload.data(), static_cast<int>(payload.size()));
        // What was due before a subscription is not part of what comes after it.
        if (at % 3 == 0) drain();
        client.session->on_message(payload);
        const auto& subscribe = asked.subscribe();
        const bool follows = subscribe.run() <= 1 && subscribe.max_rate_hz() >= 0.0 && subscribe.max_rate_hz() <= 1e300;
        if (parsed && asked.has_subscribe() && follows) {
            after = std::min(subscribe.after_seq(), ground.last);  // of the future there is nothing yet
            client.welcomed = false;
        }
        ground.publish(items_a_message, at % 5 != 0);
        if (!client.session->closing().empty()) return 0;
        if (at % 2 == 0) drain();
    }
    drain();
    must(!client.welcomed || client.through == ground.last);
    return 0;
}
