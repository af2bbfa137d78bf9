// SPDX-License-Identifier: Apache-2.0
#include "server/cluster/engine.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <map>
#include <mutex>
#include <nats/nats.h>
#include <utility>

namespace aeolis::server::cluster {
// Handles of the library, each destroyed by its own function. Named, because members of this file's classes have them.
namespace handles {

template <typename Handle, auto destroy>
struct Destroyer {
    void operator()(Handle* handle) const { destroy(handle); }
};
template <typename Handle, auto destroy>
using Owned = std::unique_ptr<Handle, Destroyer<Handle, destroy>>;

using Options = Owned<natsOptions, natsOptions_Destroy>;
using Connection = Owned<natsConnection, natsConnection_Destroy>;
using Streams = Owned<jsCtx, jsCtx_Destroy>;
using Subscription = Owned<natsSubscription, natsSubscription_Destroy>;
using Message = Owned<natsMsg, natsMsg_Destroy>;
using StreamInfo = Owned<jsStreamInfo, jsStreamInfo_Destroy>;
using ConsumerInfo = Owned<jsConsumerInfo, jsConsumerInfo_Destroy>;
using PubAck = Owned<jsPubAck, jsPubAck_Destroy>;
using MetaData = Owned<jsMsgMetaData, jsMsgMetaData_Destroy>;

/// The first refusal of what was published without waiting. A thread of the library tells of it, and may do so after
/// its connection was closed: it knows a number, behind which nobody may be left.
class Refusals {
  public:
    Refusals() {
        const std::scoped_lock lock{mutex};
        number_ = ++last;
        all.emplace(number_, "");
    }
    Refusals(const Refusals&) = delete;
    Refusals& operator=(const Refusals&) = delete;
    ~Refusals() {
        const std::scoped_lock lock{mutex};
        all.erase(number_);
    }
    /// As the library hands it back.
    void* number() const { return reinterpret_cast<void*>(number_); }
    static void tell(void* number, const char* why) {
        const std::scoped_lock lock{mutex};
        const auto one = all.find(reinterpret_cast<std::uintptr_t>(number));
        if (one != all.end() && one->second.empty()) one->second = why;
    }
    /// Empty: there was none since it was taken.
    std::string take() {
        const std::scoped_lock lock{mutex};
        return std::exchange(all.at(number_), {});
    }

  private:
    static inline std::mutex mutex;
    static inline std::uintptr_t last = 0;
    static inline std::map<std::uintptr_t, std::string> all;
    std::uintptr_t number_ = 0;
};

}  // namespace handles
namespace {

using namespace handles;

constexpr std::int64_t second_ns = 1'000'000'000;
constexpr std::int64_t forgotten_after_s = 30 * 24 * 3600;  // chosen: what nobody took for a month, nobody will
constexpr std::int64_t reader_forgotten_after_s = 300;      // chosen: it is made again where it was
constexpr std::int64_t reconnect_wait_ms = 250;
constexpr std::int64_t pending_max = 2048;     // published and not yet confirmed: as in the figure of the limits
constexpr std::int64_t ping_every_ms = 5'000;  // chosen: a network that swallows all is known after two of them
constexpr int pings_out_max = 2;
constexpr int replicas_of_several = 3;  // of a stream, where three engines and more are named: one may be lost

/// What stands before an '@' may be a secret, and hold commas and slashes: all of it is left out, though it be of
/// several URLs.
std::string without_secrets(const std::string& urls) {
    const auto at = urls.rfind('@');
    if (at == std::string::npos) return urls;
    const auto scheme = urls.find("://");
    return (scheme < at ? urls.substr(0, scheme + 3) : "") + urls.substr(at + 1);
}

/// The URLs between whose commas stands a scheme: a secret may hold commas too.
std::vector<std::string> each_url(const std::string& urls) {
    std::vector<std::string> all;
    for (std::size_t begin = 0; begin != std::string::npos;) {
        const auto next = std::min(urls.find(",nats://", begin), urls.find(",tls://", begin));
        all.push_back(urls.substr(begin, next == std::string::npos ? next : next - begin));
        begin = next == std::string::npos ? next : next + 1;
    }
    return all;
}

std::string text_of(natsStatus status, jsErrCode code) {
    if (status == NATS_TIMEOUT) return "no answer";
    if (status == NATS_NO_RESPONDERS)
        return "nobody there takes it: no such stream, or no JetStream (start it with -js)";
    if (code == JSNotEnabledErr) return "JetStream is not enabled there (start it with -js)";
    if (code == JSNotEnabledForAccountErr) return "JetStream is not enabled for this account";
    const char* detail = nats_GetLastError(nullptr);
    if (detail == nullptr || *detail == '\0') return natsStatus_GetText(status);
    const std::string text{detail};  // "(conn.c:1234): why"
    const auto place = text.starts_with('(') ? text.find("): ") : std::string::npos;
    return place == std::string::npos ? text : text.substr(place + 3);
}

}  // namespace

std::string shown(const EngineAddress& address) {
    return without_secrets(address.url);
}

struct Given::State {
    Message message;
    std::uint64_t times = 1, place = 0, count = 0;
    std::string engine;
};

Given::Given(std::unique_ptr<State> state) : state_(std::move(state)) {}
Given::Given(Given&&) noexcept = default;
Given& Given::operator=(Given&&) noexcept = default;
Given::~Given() = default;

std::string_view Given::octets() const {
    return {natsMsg_GetData(state_->message.get()),
            static_cast<std::size_t>(natsMsg_GetDataLength(state_->message.get()))};
}
std::uint64_t Given::times() const {
    return state_->times;
}
std::uint64_t Given::place() const {
    return state_->place;
}
std::uint64_t Given::count() const {
    return state_->count;
}
Result<void> Given::take() {
    jsOptions options;
    jsOptions_Init(&options);
    options.Wait = Engine::patience.count();
    jsErrCode code{};
    const auto status = natsMsg_AckSync(state_->message.get(), &options, &code);
    if (status == NATS_OK) return {};
    return Error{fmt::format("{}: a message could not be marked as taken: {}", state_->engine, text_of(status, code))};
}
void Given::keep_waiting() {
    natsMsg_InProgress(state_->message.get(), nullptr);
}
void Given::give_back() {
    natsMsg_Nak(state_->message.get(), nullptr);
}

struct Consumer::State {
    Subscription subscription;
    std::string engine, name;
};

Consumer::Consumer(std::unique_ptr<State> state) : state_(std::move(state)) {}
Consumer::Consumer(Consumer&&) noexcept = default;
Consumer& Consumer::operator=(Consumer&&) noexcept = default;
Consumer::~Consumer() = default;

Result<std::vector<Given>> Consumer::next(std::size_t count, std::chrono::milliseconds wait) {
    natsMsgList list{};
    jsErrCode code{};
    const auto status =
        natsSubscription_Fetch(&list, state_->subscription.get(), static_cast<int>(count), wait.count(), &code);
    if (status != NATS_OK && status != NATS_TIMEOUT)
        return Error{fmt::format("{}: {}: {}", state_->engine, state_->name, text_of(status, code))};
    std::vector<Given> given;
    for (int i = 0; i < list.Count; ++i) {
        auto state = std::make_unique<Given::State>();
        state->message.reset(std::exchange(list.Msgs[i], nullptr));
        state->engine = state_->engine;
        jsMsgMetaData* read = nullptr;
        if (natsMsg_GetMetaData(&read, state->message.get()) == NATS_OK) {
            const MetaData data{read};
            state->times = data->NumDelivered;
            state->place = data->Sequence.Stream;
            state->count = data->Sequence.Consumer;
        }
        given.push_back(Given{std::move(state)});
    }
    natsMsgList_Destroy(&list);
    return given;
}

struct Listening::State {
    Subscription subscription;
    std::string engine, subject;
};

Listening::Listening(std::unique_ptr<State> state) : state_(std::move(state)) {}
Listening::Listening(Listening&&) noexcept = default;
Listening& Listening::operator=(Listening&&) noexcept = default;
Listening::~Listening() = default;

Result<std::optional<PlainMessage>> Listening::next(std::chrono::milliseconds wait) {
    natsMsg* came = nullptr;
    const auto status = natsSubscription_NextMsg(&came, state_->subscription.get(), wait.count());
    const Message message{came};
    if (status == NATS_TIMEOUT) return std::optional<PlainMessage>{};
    if (status != NATS_OK && status != NATS_SLOW_CONSUMER)
        return Error{fmt::format("{}: {}: {}", state_->engine, state_->subject, text_of(status, {}))};
    if (came == nullptr) return std::optional<PlainMessage>{};
    const char* const answer_to = natsMsg_GetReply(came);
    return std::optional{PlainMessage{natsMsg_GetSubject(came),
                                      {natsMsg_GetData(came), static_cast<std::size_t>(natsMsg_GetDataLength(came))},
                                      answer_to != nullptr ? answer_to : "",
                                      natsMsg_IsNoResponders(came)}};
}

struct Engine::State {
    std::string shown;
    int replicas = 1;  // of streams that it makes
    Refusals refusals;
    Connection connection;
    Streams streams;

    Error refused(const std::string& what, natsStatus status, jsErrCode code = {}) const {
        return Error{fmt::format("{}: {}: {}", shown, what, text_of(status, code))};
    }
};

Engine::Engine(std::unique_ptr<State> state) : state_(std::move(state)) {}
Engine::Engine(Engine&&) noexcept = default;
Engine& Engine::operator=(Engine&&) noexcept = default;
Engine::~Engine() = default;

Result<Engine> Engine::connect(const EngineAddress& address, const std::string& name) {
    auto state = std::make_unique<State>();
    state->shown = shown(address);
    natsOptions* made = nullptr;
    auto status = natsOptions_Create(&made);
    const Options options{made};
    const auto then = [&status](natsStatus next) { status = status == NATS_OK ? next : status; };
    const auto urls = each_url(address.url);
    std::vector<const char*> servers;
    servers.reserve(urls.size());
    for (const auto& url : urls) servers.push_back(url.c_str());
    if (urls.size() >= replicas_of_several) state->replicas = replicas_of_several;
    then(natsOptions_SetServers(made, servers.data(), static_cast<int>(servers.size())));
    // By itself the library speaks without TLS to an engine that asks for none, whatever the scheme.
    if (std::ranges::any_of(urls, [](const auto& url) { return url.starts_with("tls://"); }))
        then(natsOptions_SetSecure(made, true));
    then(natsOptions_SetName(made, name.c_str()));
    then(natsOptions_SetTimeout(made, patience.count()));
    then(natsOptions_SetMaxReconnect(made, -1));
    then(natsOptions_SetReconnectWait(made, reconnect_wait_ms));
    then(natsOptions_SetWriteDeadline(made, patience.count()));  // else a network that takes nothing is waited for
    then(natsOptions_SetPingInterval(made, ping_every_ms));
    then(natsOptions_SetMaxPingsOut(made, pings_out_max));
    if (status != NATS_OK) return Error{fmt::format("--nats {}: not the address of an engine", state->shown)};
    const auto file = [&](const std::filesystem::path& path, const char* option, auto&& set) -> Result<void> {
        if (path.empty() || set(path.c_str()) == NATS_OK) return {};
        return Error{fmt::format("{} {}: {}", option, path.string(), text_of(NATS_ERR, {}))};
    };
    if (const auto read =
            file(address.credentials, "--nats-credentials",
                 [&](const char* path) { return natsOptions_SetUserCredentialsFromFiles(made, path, nullptr); });
        !read)
        return read.error();
    if (const auto read =
            file(address.nkey_seed, "--nats-nkey-seed",
                 [&](const char* path) { return natsOptions_SetNKeyFromSeed(made, address.nkey.c_str(), path); });
        !read)
        return read.error();
    if (const auto read = file(address.ca, "--nats-ca",
                               [&](const char* path) { return natsOptions_LoadCATrustedCertificates(made, path); });
        !read)
        return read.error();
    if (const auto read =
            file(address.certificate, "--nats-certificate",
                 [&](const char* path) { return natsOptions_LoadCertificatesChain(made, path, address.key.c_str()); });
        !read)
        return read.error();
    natsConnection* connection = nullptr;
    status = natsConnection_Connect(&connection, made);
    if (status != NATS_OK) return Error{fmt::format("{}: {}", state->shown, text_of(status, {}))};
    state->connection.reset(connection);
    jsOptions defaults;
    jsOptions_Init(&defaults);
    defaults.Wait = patience.count();
    defaults.PublishAsync.MaxPending = pending_max;
    // Without this the library takes a refusal for done.
    defaults.PublishAsync.ErrHandler = [](jsCtx*, jsPubAckErr* refusal, void* number) {
        Refusals::tell(number, refusal->ErrText != nullptr ? refusal->ErrText : "refused");
    };
    defaults.PublishAsync.ErrHandlerClosure = state->refusals.number();
    jsCtx* streams = nullptr;
    status = natsConnection_JetStream(&streams, connection, &defaults);
    if (status != NATS_OK) return state->refused("JetStream", status);
    state->streams.reset(streams);
    return Engine{std::move(state)};
}

bool Engine::connected() const {
    return natsConnection_Status(state_->connection.get()) == NATS_CONN_STATUS_CONNECTED;
}

Result<void> Engine::make_stream(const std::string& stream, const std::string& subjects, Retention retention) {
    jsStreamConfig config;
    jsStreamConfig_Init(&config);
    config.Name = stream.c_str();
    const char* list[]{subjects.c_str()};
    config.Subjects = list;
    config.SubjectsLen = 1;
    config.Retention = retention == Retention::until_taken ? js_WorkQueuePolicy : js_LimitsPolicy;
    config.Storage = js_FileStorage;
    config.Replicas = state_->replicas;
    if (retention == Retention::newest)
        config.MaxMsgsPerSubject = 1;
    else
        config.MaxAge = forgotten_after_s * second_ns;
    jsErrCode code{};
    jsStreamInfo* info = nullptr;
    // An engine's administrator may have made it with more replicas or bounds; then it is used as it is.
    if (js_GetStreamInfo(&info, state_->streams.get(), stream.c_str(), nullptr, &code) == NATS_OK) {
        const StreamInfo there{info};
        if (there->Config->Retention == config.Retention) return {};
        return Error{fmt::format("{}: there is a stream {} of another form: remove it", state_->shown, stream)};
    }
    const auto status = js_AddStream(&info, state_->streams.get(), &config, nullptr, &code);
    const StreamInfo made{info};
    if (status != NATS_OK) return state_->refused("stream " + stream, status, code);
    return {};
}

Result<void> Engine::publish(const std::string& subject, std::string_view octets) {
    jsErrCode code{};
    const auto status = js_Publish(nullptr, state_->streams.get(), subject.c_str(), octets.data(),
                                   static_cast<int>(octets.size()), nullptr, &code);
    if (status != NATS_OK) return state_->refused("publishing to " + subject, status, code);
    return {};
}

Result<void> Engine::publish(const std::string& subject, const std::vector<std::string>& messages) {
    (void)state_->refusals.take();
    auto status = NATS_OK;
    for (auto message = messages.begin(); message != messages.end() && status == NATS_OK; ++message)
        status = js_PublishAsync(state_->streams.get(), subject.c_str(), message->data(),
                                 static_cast<int>(message->size()), nullptr);
    jsPubOptions options;
    jsPubOptions_Init(&options);
    options.MaxWait = patience.count();
    if (status == NATS_OK) status = js_PublishAsyncComplete(state_->streams.get(), &options);
    natsMsgList left{};  // not confirmed, and no more waited for
    if (js_PublishAsyncGetPendingList(&left, state_->streams.get()) == NATS_OK) natsMsgList_Destroy(&left);
    if (status != NATS_OK) return state_->refused("publishing to " + subject, status);
    if (const auto why = state_->refusals.take(); !why.empty())
        return Error{fmt::format("{}: publishing to {}: {}", state_->shown, subject, why)};
    return {};
}

Result<std::vector<std::string>> Engine::subjects(const std::string& stream, const std::string& filter) {
    jsOptions options;
    jsOptions_Init(&options);
    options.Wait = patience.count();
    options.Stream.Info.SubjectsFilter = filter.c_str();
    jsErrCode code{};
    jsStreamInfo* info = nullptr;
    const auto status = js_GetStreamInfo(&info, state_->streams.get(), stream.c_str(), &options, &code);
    const StreamInfo there{info};
    std::vector<std::string> found;
    if (status == NATS_NOT_FOUND) return found;
    if (status != NATS_OK) return state_->refused("stream " + stream, status, code);
    if (const auto* list = there->State.Subjects; list != nullptr)
        for (int i = 0; i < list->Count; ++i) found.emplace_back(list->List[i].Subject);
    return found;
}

Result<std::optional<Stored>> Engine::newest(const std::string& stream, const std::string& subject) {
    natsMsg* message = nullptr;
    jsErrCode code{};
    const auto status = js_GetLastMsg(&message, state_->streams.get(), stream.c_str(), subject.c_str(), nullptr, &code);
    const Message owned{message};
    if (status == NATS_NOT_FOUND) return std::optional<Stored>{};
    if (status != NATS_OK) return state_->refused(subject, status, code);
    return std::optional{Stored{{natsMsg_GetData(message), static_cast<std::size_t>(natsMsg_GetDataLength(message))},
                                natsMsg_GetSequence(message)}};
}

Result<std::uint64_t> Engine::publish_after(const std::string& subject, std::string_view octets, std::uint64_t after) {
    jsPubOptions options;
    jsPubOptions_Init(&options);
    options.MaxWait = patience.count();
    options.ExpectLastSubjectSeq = after;
    options.ExpectNoMessage = after == 0;
    jsErrCode code{};
    jsPubAck* confirmed = nullptr;
    const auto status = js_Publish(&confirmed, state_->streams.get(), subject.c_str(), octets.data(),
                                   static_cast<int>(octets.size()), &options, &code);
    const PubAck owned{confirmed};
    if (status != NATS_OK) return state_->refused("publishing to " + subject, status, code);
    return owned->Sequence;
}

Result<Engine::StreamFacts> Engine::facts(const std::string& stream) {
    jsErrCode code{};
    jsStreamInfo* info = nullptr;
    const auto status = js_GetStreamInfo(&info, state_->streams.get(), stream.c_str(), nullptr, &code);
    const StreamInfo there{info};
    if (status == NATS_NOT_FOUND) return StreamFacts{};
    if (status != NATS_OK) return state_->refused("stream " + stream, status, code);
    return StreamFacts{fmt::format("{}", there->Created), there->State.FirstSeq, there->State.LastSeq};
}

Result<void> Engine::clear(const std::string& stream, const std::string& subject) {
    jsOptions options;
    jsOptions_Init(&options);
    options.Wait = patience.count();
    options.Stream.Purge.Subject = subject.c_str();
    jsErrCode code{};
    const auto status = js_PurgeStream(state_->streams.get(), stream.c_str(), &options, &code);
    if (status != NATS_OK) return state_->refused("clearing " + subject, status, code);
    return {};
}

Result<void> Engine::make_consumer(const std::string& stream, const std::string& name, const std::string& subject,
                                   std::chrono::seconds again_after) {
    jsConsumerConfig config;
    jsConsumerConfig_Init(&config);
    config.Durable = name.c_str();
    config.FilterSubject = subject.c_str();
    config.AckPolicy = js_AckExplicit;
    config.AckWait = again_after.count() * second_ns;
    config.MaxDeliver = -1;
    config.MaxAckPending = -1;  // as many at a time as there are processors
    jsErrCode code{};
    jsConsumerInfo* info = nullptr;
    const auto status = js_AddConsumer(&info, state_->streams.get(), stream.c_str(), &config, nullptr, &code);
    const ConsumerInfo made{info};
    if (status != NATS_OK) return state_->refused("consumer " + name, status, code);
    return {};
}

Result<Consumer> Engine::read(const std::string& stream, const std::string& name, const std::string& subjects,
                              std::uint64_t from) {
    if (const auto removed = remove_consumer(stream, name); !removed) return removed.error();
    jsConsumerConfig config;
    jsConsumerConfig_Init(&config);
    config.Durable = name.c_str();
    config.FilterSubject = subjects.c_str();
    config.DeliverPolicy = from > 1 ? js_DeliverByStartSequence : js_DeliverAll;
    config.OptStartSeq = from > 1 ? from : 0;
    config.AckPolicy = js_AckNone;
    config.InactiveThreshold = reader_forgotten_after_s * second_ns;
    jsErrCode code{};
    jsConsumerInfo* info = nullptr;
    const auto status = js_AddConsumer(&info, state_->streams.get(), stream.c_str(), &config, nullptr, &code);
    const ConsumerInfo made{info};
    if (status != NATS_OK) return state_->refused("reading " + subjects, status, code);
    return consumer(stream, name, subjects);
}

Result<void> Engine::remove_consumer(const std::string& stream, const std::string& name) {
    jsErrCode code{};
    const auto status = js_DeleteConsumer(state_->streams.get(), stream.c_str(), name.c_str(), nullptr, &code);
    if (status != NATS_OK && status != NATS_NOT_FOUND) return state_->refused("consumer " + name, status, code);
    return {};
}

Result<Consumer> Engine::consumer(const std::string& stream, const std::string& name, const std::string& subject) {
    jsSubOptions options;
    jsSubOptions_Init(&options);
    options.Stream = stream.c_str();
    options.Consumer = name.c_str();
    jsErrCode code{};
    natsSubscription* subscription = nullptr;
    const auto status =
        js_PullSubscribe(&subscription, state_->streams.get(), subject.c_str(), name.c_str(), nullptr, &options, &code);
    if (status != NATS_OK) return state_->refused("consumer " + name, status, code);
    auto state = std::make_unique<Consumer::State>();
    state->subscription.reset(subscription);
    state->engine = state_->shown;
    state->name = name;
    return Consumer{std::move(state)};
}

Result<std::uint64_t> Engine::untaken(const std::string& stream, const std::string& consumer) {
    jsErrCode code{};
    jsConsumerInfo* info = nullptr;
    const auto status =
        js_GetConsumerInfo(&info, state_->streams.get(), stream.c_str(), consumer.c_str(), nullptr, &code);
    const ConsumerInfo there{info};
    if (status != NATS_OK) return state_->refused("consumer " + consumer, status, code);
    return there->NumPending + static_cast<std::uint64_t>(there->NumAckPending);
}

Result<void> Engine::send(const std::string& subject, std::string_view octets, const std::string& answer_to) {
    auto* const connection = state_->connection.get();
    const auto size = static_cast<int>(octets.size());
    const auto status = answer_to.empty() ? natsConnection_Publish(connection, subject.c_str(), octets.data(), size)
                                          : natsConnection_PublishRequest(connection, subject.c_str(),
                                                                          answer_to.c_str(), octets.data(), size);
    if (status != NATS_OK) return state_->refused(subject, status);
    return {};
}

Result<Listening> Engine::listen(const std::string& subject) {
    natsSubscription* subscription = nullptr;
    const auto status = natsConnection_SubscribeSync(&subscription, state_->connection.get(), subject.c_str());
    if (status != NATS_OK) return state_->refused(subject, status);
    auto state = std::make_unique<Listening::State>();
    state->subscription.reset(subscription);
    const auto known = natsConnection_FlushTimeout(state_->connection.get(), patience.count());
    if (known != NATS_OK) return state_->refused(subject, known);
    state->engine = state_->shown;
    state->subject = subject;
    return Listening{std::move(state)};
}

std::string Engine::own_subject() {
    natsInbox* drawn = nullptr;
    if (natsInbox_Create(&drawn) != NATS_OK) return {};
    const Owned<natsInbox, natsInbox_Destroy> inbox{drawn};
    return inbox.get();
}

}  // namespace aeolis::server::cluster
