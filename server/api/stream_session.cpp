// SPDX-License-Identifier: Apache-2.0
#include "server/api/stream_session.hpp"

#include "server/base/json.hpp"
#include "server/base/version.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace aeolis::server {
namespace {

constexpr int channel_names_max = 4'096;              // chosen: of one subscription; all_channels names them all
constexpr std::size_t channel_name_octets_max = 256;  // chosen: no dictionary's names are as long

bool is_over(const v1::RunState& run) {
    return run.state() == v1::RunState::finished || run.state() == v1::RunState::interrupted;
}

/// The ids of a subscription's channels, ascending, each once.
Result<std::vector<std::uint32_t>> channels_of(const v1::Subscribe& subscribe, const StreamHub::Services& services) {
    if (subscribe.channel_names_size() > channel_names_max)
        return Error{fmt::format("channel_names: {} of them, at most {}; all_channels takes all",
                                 subscribe.channel_names_size(), channel_names_max)};
    std::vector<std::uint32_t> ids{subscribe.channels().begin(), subscribe.channels().end()};
    if (const auto none = std::ranges::find_if_not(ids, services.has_channel); none != ids.end())
        return Error{fmt::format("channels: there is no channel with the id {}", *none)};
    for (const auto& name : subscribe.channel_names()) {
        if (name.size() > channel_name_octets_max)
            return Error{fmt::format("channel_names: one of {} octets is no name of a channel", name.size())};
        const auto id = services.channel_id(name);
        if (!id) return id.error();
        ids.push_back(*id);
    }
    std::ranges::sort(ids);
    const auto [repeats, end] = std::ranges::unique(ids);
    ids.erase(repeats, end);
    return ids;
}

}  // namespace

StreamSession::Client StreamSession::follower() {
    Client client;
    client.command = [](const v1::CommandRequest& request, const auto& reply) {
        v1::CommandReply answer;
        answer.set_request(request.request());
        answer.set_reason("this client only follows");
        reply(answer);
    };
    client.control = [](const v1::RehearsalControl&, const auto& done) { done(Error{"this client only follows"}); };
    client.refusal = [] { return std::string{}; };
    return client;
}

StreamSession::StreamSession(StreamHub& hub, StreamFormat format, std::function<void()> wake, Client client)
    : hub_(hub), wake_(std::move(wake)), client_(std::move(client)) {
    selection_.format = format;
    hub_.add(*this);
}

StreamSession::~StreamSession() {
    hub_.remove(*this);
}

std::string StreamSession::closing() const {
    if (!refusal_.empty()) return refusal_;
    return replies_.size() > replies_max ? "too many requests without reading the answers" : "";
}

void StreamSession::check() {
    look_at_rights();
    if (!refusal_.empty()) return;
    if (const auto retry = std::exchange(retry_, nullptr)) retry();
}

void StreamSession::look_at_rights() {
    if (!refusal_.empty()) return;
    refusal_ = client_.refusal();
    if (!refusal_.empty()) wake_();
}

void StreamSession::on_message(std::string_view payload) {
    v1::ClientMessage message;
    if (selection_.format == StreamFormat::json) {
        if (const auto parsed = from_json(payload, message); !parsed) return refuse(parsed.error().message);
    } else if (!message.ParseFromArray(payload.data(), static_cast<int>(payload.size()))) {
        return refuse(fmt::format("these {} octets are not a ClientMessage of aeolis.v1", payload.size()));
    }
    look_at_rights();
    if (!refusal_.empty()) return;
    const auto self = weak_from_this();
    switch (message.message_case()) {
    case v1::ClientMessage::kSubscribe: return subscribe(message.subscribe());
    case v1::ClientMessage::kCommand:
        return client_.command(message.command(), [self](v1::CommandReply answer) {
            const auto session = self.lock();
            if (!session) return;
            v1::ServerMessage out;
            *out.mutable_command_reply() = std::move(answer);
            session->reply(out);
        });
    case v1::ClientMessage::kControl:
        return client_.control(message.control(), [self](const Result<void>& done) {
            const auto session = self.lock();
            if (session && !done) session->refuse(done.error().message);
        });
    case v1::ClientMessage::MESSAGE_NOT_SET: break;
    }
    refuse("the message says nothing: subscribe, command or control is wanted");
}

void StreamSession::refuse(std::string reason, bool goes_on) {
    ++hub_.figures.refusals;
    v1::ServerMessage message;
    message.mutable_refusal()->set_reason(std::move(reason));
    message.mutable_refusal()->set_goes_on(goes_on);
    reply(message);
}

void StreamSession::reply(const v1::ServerMessage& message) {
    replies_.push_back(encode(message, selection_.format));
    wake_();
}

void StreamSession::subscribe(const v1::Subscribe& subscribe) {
    if (!std::isfinite(subscribe.max_rate_hz()) || subscribe.max_rate_hz() < 0.0)
        return refuse(fmt::format("max_rate_hz: {} is not a rate", subscribe.max_rate_hz()));
    if (subscribe.run() > UINT32_MAX) return refuse(fmt::format("run {}: there is none", subscribe.run()));
    const std::uint64_t run = subscribe.run() == 0 ? hub_.current_run() : subscribe.run();
    if (auto refusal = refusal_of_pace(subscribe.pace(), run); !refusal.empty()) return refuse(std::move(refusal));
    auto channels = channels_of(subscribe, hub_.services());
    if (!channels) return refuse(channels.error().message);
    ++subscription_;
    retry_ = next_question_ = nullptr;
    waiting_for_run_ = stall_told_ = false;
    due_.reset();
    selection_.all_channels = subscribe.all_channels();
    selection_.channels = std::move(*channels);
    selection_.max_rate_hz = subscribe.max_rate_hz();
    selection_.packets = !subscribe.without_units();
    pace_ = subscribe.pace();
    newest_run_ = subscribe.run() == 0 && pace_ == 0.0;  // a replay goes to its end, even if another run begins
    if (run == 0 || run == hub_.current_run()) {
        older_run_.Clear();
        if (pace_ > 0.0) {
            older_run_ = hub_.state();
            older_run_.set_last_seq(hub_.last_seq());
        }
        subscribed_ = true;
        follow(run, subscribe.after_seq());
        wake_();
        return;
    }
    read_run(run, subscribe.after_seq());
}

std::string StreamSession::refusal_of_pace(double pace, std::uint64_t run) const {
    if (!std::isfinite(pace) || pace < 0.0 || pace > ReplaySchedule::pace_max)
        return fmt::format("pace: {} is none: above 0 and up to {} is wanted, or 0 for as fast as it goes", pace,
                           ReplaySchedule::pace_max);
    if (pace == 0.0) return {};
    if (run == 0) return "pace: it is for a run that is over, and there is none yet";
    if (run == hub_.current_run() && !is_over(hub_.state()))
        return fmt::format(
            "pace: it is for a run that is over, and run {} goes on: name another, or follow this one without a pace",
            run);
    return {};
}

void StreamSession::read_run(std::uint64_t run, archive::Sequence after) {
    waiting_for_run_ = true;
    ask([this, run, after, subscription = subscription_] {
        hub_.services().read_run(run, [self = weak_from_this(), run, after, subscription](Result<v1::RunState> state) {
            const auto session = self.lock();
            if (!session) return;
            session->answered();
            if (session->subscription_ != subscription) return;
            if (!state && state.error().internal)
                return session->stall(state.error().message,
                                      [session = session.get(), run, after] { session->read_run(run, after); });
            session->waiting_for_run_ = false;
            if (!state) {
                session->refuse(state.error().message);
                if (session->newest_run_) session->follow(session->hub_.current_run(), 0);
                return;
            }
            session->subscribed_ = true;
            session->older_run_ = std::move(*state);
            session->follow(run, after);
            session->wake_();
        });
    });
}

void StreamSession::ask(std::function<void()> question) {
    if (asking_) {
        next_question_ = std::move(question);
        return;
    }
    asking_ = true;
    question();
}

void StreamSession::answered() {
    asking_ = false;
    if (auto next = std::exchange(next_question_, nullptr)) ask(std::move(next));
}

void StreamSession::lose_run(std::string why) {
    subscribed_ = false;
    refuse(std::move(why));
}

void StreamSession::stall(const std::string& why, std::function<void()> retry) {
    retry_ = std::move(retry);
    if (!std::exchange(stall_told_, true)) refuse("the archive could not be read, it is tried again: " + why, true);
}

void StreamSession::follow(std::uint64_t run, archive::Sequence after) {
    run_ = run;
    replay_ = pace_ > 0.0 ? std::optional{ReplaySchedule{pace_}} : std::nullopt;
    due_.reset();
    next_batch_ = {};
    // A position beyond the end means another run: start at the end.
    const auto last = replay_ || run != hub_.current_run() ? older_run_.last_seq() : hub_.last_seq();
    cursor_ = sent_through_ = std::min(after, last);
    left_out_ = 0;
    left_out_before_.clear();
    page_.reset();
    page_spacing_ = SampleSpacing{cursor_ == 0, hub_.services().rate_by};
    reading_ = exhausted_ = was_live_ = stall_told_ = false;
    retry_ = nullptr;
    welcome_due_ = true;
}

Encoded StreamSession::welcome() {
    welcome_due_ = false;
    v1::ServerMessage message;
    auto& welcome = *message.mutable_welcome();
    welcome.set_server_version(version);
    welcome.set_dictionary_id(hub_.dictionary_id());
    if (run_ != 0) {
        auto& state = *welcome.mutable_run_state();
        state = follows_current() ? hub_.state() : older_run_;
        const auto last = follows_current() ? hub_.last_seq() : older_run_.last_seq();
        state.set_last_seq(last);
        welcome.set_first_seq(last == 0 ? 0 : 1);
        welcome.set_last_seq(last);
    }
    if (follows_current()) state_sent_ = hub_.state_version();
    return encode(message, selection_.format);
}

bool StreamSession::behind() const {
    if (replay_) return !replies_.empty() || (due_ && *due_ <= hub_.services().now());
    return !replies_.empty() ||
           (subscribed_ && run_ != 0 && (follows_current() ? cursor_ < hub_.last_seq() : !exhausted_));
}

Encoded StreamSession::next_message() {
    auto message = next_due();
    if (message) {
        ++hub_.figures.messages;
        hub_.figures.octets += message->size();
    }
    return message;
}

Encoded StreamSession::next_due() {
    if (!refusal_.empty()) return nullptr;
    if (!replies_.empty()) {
        auto message = replies_.front();
        replies_.pop_front();
        return message;
    }
    if (!subscribed_ || waiting_for_run_) return nullptr;
    if (newest_run_ && run_ != hub_.current_run()) {
        if (auto state = last_state_of_run()) return state;
        const bool from_archive = older_run_.run() == run_;  // it is read to its end
        if (!gave_all_of_run() && !from_archive) {
            ++subscription_;  // drops a page in flight; it is read again
            read_run(run_, cursor_);
            return nullptr;
        }
        if (gave_all_of_run()) {
            if (sent_through_ < cursor_) return progress();
            ++subscription_;
            follow(hub_.current_run(), 0);
        }
    }
    if (welcome_due_) return welcome();
    if (run_ == 0) return nullptr;
    if (follows_current() && state_sent_ != hub_.state_version()) {
        state_sent_ = hub_.state_version();
        tell_through_ = true;
        return hub_.encoded_state(selection_.format);
    }
    if (auto message = next_items()) return message;
    if (!follows_current() || reading_ || retry_) return nullptr;
    const bool through_due = std::exchange(tell_through_, false) && sent_through_ < cursor_;
    return through_due || clocks_sent_ != hub_.clocks_version() ? progress() : nullptr;
}

Encoded StreamSession::progress() {
    v1::ServerMessage message;
    auto& batch = *message.mutable_batch();
    batch.set_run(run_);
    batch.set_after_seq(std::exchange(sent_through_, cursor_));
    batch.set_complete_through(cursor_);
    batch.set_left_out(std::exchange(left_out_, 0));
    if (follows_current()) {
        clocks_sent_ = hub_.clocks_version();
        *batch.mutable_clocks() = hub_.latest_clocks();
    }
    return encode(message, selection_.format);
}

bool StreamSession::gave_all_of_run() const {
    if (run_ == 0) return true;
    if (older_run_.run() == run_) return exhausted_ && !page_;
    return hub_.previous_run_state().run() == run_ && cursor_ >= hub_.previous_run_state().last_seq();
}

Encoded StreamSession::last_state_of_run() {
    if (hub_.previous_run_state().run() != run_ || cursor_ < hub_.previous_run_state().last_seq() ||
        state_sent_ >= hub_.previous_run_state_version())
        return nullptr;
    state_sent_ = hub_.previous_run_state_version();
    v1::ServerMessage message;
    *message.mutable_run_state() = hub_.previous_run_state();
    return encode(message, selection_.format);
}

Encoded StreamSession::next_items() {
    for (;;) {
        if (page_) {
            if (auto message = from_page()) return message;
            if (due_) return nullptr;
            continue;
        }
        if (reading_ || retry_) return nullptr;
        if (!follows_current()) {
            if (!exhausted_) ask_archive();
            return nullptr;
        }
        if (cursor_ >= hub_.last_seq()) {
            was_live_ = true;
            return nullptr;
        }
        if (!hub_.holds(cursor_)) {
            ask_archive();
            return nullptr;
        }
        page_spacing_.add_left_out(selection_.interval_s(), left_out_before_);
        const auto encoded = hub_.encoded_range(selection_, cursor_, sent_through_, left_out_, left_out_before_);
        cursor_ = encoded.through;
        left_out_ = encoded.left_out;
        page_spacing_ = SampleSpacing{
            false, hub_.services().rate_by};  // a later page begins behind samples that were not seen here
        if (!encoded.message) continue;
        sent_through_ = encoded.through;
        left_out_ = 0;
        clocks_sent_ = hub_.clocks_version();
        return encoded.message;
    }
}

std::optional<archive::ItemPage> StreamSession::take_page() {
    due_.reset();
    const auto now = hub_.services().now();
    if (replay_ && next_batch_ > now) {
        due_ = next_batch_;
        return std::nullopt;
    }
    archive::ItemPage part;
    auto& items = page_->items;
    const auto items_max = selection_.format == StreamFormat::json ? json_items : items.size();
    while (page_taken_ < items.size() && part.items.size() < items_max) {
        if (const auto due = replay_ ? replay_->due(items[page_taken_], now) : now; due > now) {
            due_ = due;
            break;
        }
        part.items.push_back(std::move(items[page_taken_++]));
    }
    if (part.items.empty() && due_) return std::nullopt;
    const bool rest = page_taken_ < items.size();
    part.complete_through = rest ? part.items.back().seq() : page_->complete_through;
    part.more = rest || page_->more;
    if (!rest) page_.reset();
    if (replay_ && (due_ || !rest)) next_batch_ = now + replay_interval;
    return part;
}

Encoded StreamSession::from_page() {
    const auto taken = take_page();
    if (!taken) return nullptr;
    const auto& page = *taken;
    const double interval_s = selection_.interval_s();
    const bool catching_up = interval_s > 0.0 && was_live_ && follows_current();
    const auto stretch = catching_up ? static_cast<float>(std::max(1.0, catching_up_interval_s / interval_s)) : 1.0F;
    std::vector<ItemWithFacts> items;
    items.reserve(page.items.size());
    for (const auto& item : page.items) items.push_back({&item, page_spacing_.next(item, stretch)});
    v1::ServerMessage message;
    auto& batch = *message.mutable_batch();
    batch.set_left_out(left_out_);
    select_items(selection_, interval_s, items, batch);
    left_out_ = batch.left_out();
    cursor_ = std::max(cursor_, page.complete_through);
    exhausted_ = !page.more;
    const bool last = exhausted_ || (follows_current() && cursor_ >= hub_.last_seq());
    // A page without selected items is not sent, except the last: it reports that the past is complete.
    if (batch.items_size() == 0 && !last) return nullptr;
    batch.set_run(run_);
    batch.set_history(true);
    batch.set_after_seq(sent_through_);
    batch.set_complete_through(cursor_);
    if (follows_current()) *batch.mutable_clocks() = hub_.latest_clocks();
    sent_through_ = cursor_;
    left_out_ = 0;
    return encode(message, selection_.format);
}

void StreamSession::ask_archive() {
    reading_ = true;
    ask([this] { read_page(); });
}

void StreamSession::read_page() {
    ++hub_.figures.archive_pages;
    archive::Reader::ItemKinds kinds;
    kinds.samples = selection_.all_channels || !selection_.channels.empty();
    kinds.packets = selection_.packets || replay_;  // a replay needs packets for their times on Earth
    hub_.services().read_items(archive::RunId{static_cast<std::uint32_t>(run_)}, cursor_, page_items, kinds,
                               [self = weak_from_this(), subscription = subscription_](Result<archive::ItemPage> page) {
                                   const auto session = self.lock();
                                   if (!session) return;
                                   session->answered();
                                   if (session->subscription_ != subscription) return;
                                   session->reading_ = false;
                                   const auto retry = [session = session.get()] { session->ask_archive(); };
                                   if (!page && !page.error().internal) return session->lose_run(page.error().message);
                                   if (!page) return session->stall(page.error().message, retry);
                                   if (page->complete_through <= session->cursor_ && session->follows_current())
                                       return session->stall(fmt::format("it holds nothing after {}", session->cursor_),
                                                             retry);
                                   session->stall_told_ = false;
                                   session->page_ = std::move(*page);
                                   session->page_taken_ = 0;
                                   session->wake_();
                               });
}

}  // namespace aeolis::server
