// SPDX-License-Identifier: Apache-2.0
#include "server/cluster/request_sender.hpp"

#include "server/access/secrets.hpp"
#include "server/cluster/run_messages.hpp"
#include "server/cluster/signed_request.hpp"

#include <condition_variable>
#include <deque>
#include <fmt/format.h>
#include <map>
#include <mutex>
#include <optional>
#include <spdlog/spdlog.h>
#include <thread>
#include <utility>

namespace aeolis::server::cluster {
namespace {

using Clock = std::chrono::steady_clock;

constexpr unsigned no_answer_status = 503;

v1::RequestAnswer no_answer(const std::string& why) {
    v1::RequestAnswer answer;
    answer.set_status(no_answer_status);
    answer.set_body(why);
    return answer;
}

}  // namespace

class RequestSender::Thread {
  public:
    explicit Thread(Settings settings)
        : settings_(std::move(settings)), answers_to_(Engine::own_subject()), thread_([this] { run(); }) {}
    ~Thread() {
        {
            const std::scoped_lock lock{mutex_};
            stop_ = true;
        }
        wake_.notify_all();
        thread_.join();
        for (auto& [subject, sent] : sent_) sent.answered(no_answer(ends));
        for (auto& waiting : waiting_) waiting.answered(no_answer(ends));
    }

    void ask(v1::FollowerRequest request, Answered answered) {
        {
            const std::scoped_lock lock{mutex_};
            if (waiting_.size() < waiting_max) {
                waiting_.push_back({std::move(request), std::move(answered)});
                answered = nullptr;
            }
        }
        if (answered) {  // never sent, so that it may be sent again
            auto full = no_answer("too many requests wait for the origin: try again");
            full.set_retry_after_s(1);
            return answered(std::move(full));
        }
        wake_.notify_all();
    }

  private:
    static constexpr const char* ends = "this server ends: whether the origin has done it, its stream will tell";
    struct Waiting {
        v1::FollowerRequest request;
        Answered answered;
    };
    struct Sent {
        Answered answered;
        Clock::time_point until;
    };

    void run() {
        while (!stopped()) {
            const auto done = work();
            if (done) continue;
            give_up(done.error().message);
            wait(settings_.again_after);
        }
    }

    Result<void> work() {
        if (!engine_) {
            auto engine = Engine::connect(settings_.engine, "aeolis follower requests");
            if (!engine) return engine.error();
            engine_.emplace(std::move(*engine));
        }
        if (!engine_->connected()) return Error{shown(settings_.engine) + ": the engine is away"};
        if (!answers_) {
            auto answers = engine_->listen(answers_to_ + ".*");
            if (!answers) return answers.error();
            answers_.emplace(std::move(*answers));
        }
        if (auto sent = send_waiting(); !sent) return sent;
        if (sent_.empty()) {
            std::unique_lock lock{mutex_};
            wake_.wait_for(lock, settings_.again_after, [this] { return stop_ || !waiting_.empty(); });
            return {};
        }
        const auto came = answers_->next(settings_.look_every);
        if (!came) return came.error();
        if (*came) take(**came);
        for (auto sent = sent_.begin(); sent != sent_.end();) {
            if (Clock::now() < sent->second.until) {
                ++sent;
                continue;
            }
            sent->second.answered(no_answer(
                fmt::format("the origin has not answered within {} s: whether it has done it, its stream will "
                            "tell",
                            std::chrono::duration_cast<std::chrono::seconds>(settings_.wait).count())));
            sent = sent_.erase(sent);
        }
        return {};
    }

    Result<void> send_waiting() {
        for (;;) {
            std::optional<Waiting> next;
            {
                const std::scoped_lock lock{mutex_};
                if (waiting_.empty()) return {};
                next.emplace(std::move(waiting_.front()));
                waiting_.pop_front();
            }
            auto& request = next->request;
            const auto origin = settings_.heard();
            if (origin.publisher.empty()) {
                next->answered(no_answer("the origin has not been heard here yet, and was not asked: try again"));
                continue;
            }
            request.set_origin(settings_.origin);
            request.set_publisher(origin.publisher);
            request.set_heard(origin.heard);
            request.set_number(drawn_octets(request_number_octets));
            const auto answer_to = fmt::format("{}.{}", answers_to_, ++count_);
            const auto sent = engine_->send(subject_of_requests(settings_.origin),
                                            signed_message(request, settings_.seed), answer_to);
            if (!sent) {
                next->answered(no_answer("the origin was not asked: " + sent.error().message));
                return sent;
            }
            sent_[answer_to] = {std::move(next->answered), Clock::now() + settings_.wait};
        }
    }

    void take(const PlainMessage& heard) {
        const auto sent = sent_.find(heard.subject);
        if (sent == sent_.end()) return;  // it came too late
        const auto answered = std::move(sent->second.answered);
        sent_.erase(sent);
        if (heard.nobody_there) return answered(no_answer("the origin takes no requests of followers, or is away"));
        v1::RequestAnswer answer;
        if (!answer.ParseFromString(heard.octets) || answer.status() == 0)
            answer = no_answer("what came is no answer of the origin: whether it has done it, its stream will tell");
        answered(std::move(answer));
    }

    /// The engine is away: nobody waits for that.
    void give_up(const std::string& why) {
        std::deque<Waiting> waiting;
        {
            const std::scoped_lock lock{mutex_};
            waiting.swap(waiting_);
        }
        for (auto& each : waiting) each.answered(no_answer("the origin was not asked: " + why));
        for (auto& [subject, each] : std::exchange(sent_, {}))
            each.answered(no_answer(why + ": whether the origin has done it, its stream will tell"));
        answers_.reset();
    }

    bool stopped() const {
        const std::scoped_lock lock{mutex_};
        return stop_;
    }
    void wait(std::chrono::milliseconds time) {
        std::unique_lock lock{mutex_};
        wake_.wait_for(lock, time, [this] { return stop_ || !waiting_.empty(); });
    }

    const Settings settings_;
    const std::string answers_to_;
    std::optional<Engine> engine_;
    std::optional<Listening> answers_;  // before engine_
    std::map<std::string, Sent> sent_;  // by the subject of the answer
    std::uint64_t count_ = 0;
    mutable std::mutex mutex_;  // of all below
    std::condition_variable wake_;
    bool stop_ = false;
    std::deque<Waiting> waiting_;
    std::thread thread_;
};

RequestSender::RequestSender(Settings settings) : thread_(std::make_unique<Thread>(std::move(settings))) {}
RequestSender::~RequestSender() = default;

void RequestSender::ask(v1::FollowerRequest request, Answered answered) {
    thread_->ask(std::move(request), std::move(answered));
}

}  // namespace aeolis::server::cluster
