// SPDX-License-Identifier: Apache-2.0
#include "server/cluster/request_gate.hpp"

#include "server/cluster/run_messages.hpp"

#include <condition_variable>
#include <deque>
#include <fmt/format.h>
#include <mutex>
#include <optional>
#include <set>
#include <spdlog/spdlog.h>
#include <thread>
#include <utility>

namespace aeolis::server::cluster {
namespace {

constexpr std::size_t answers_max = 1'000;      // chosen: more than may be asked in the time of an answer
constexpr std::size_t refusal_lines_max = 100;  // chosen: what is refused is counted anyway
constexpr unsigned refused_status = 403;

}  // namespace

class RequestGate::Thread {
  public:
    Thread(Settings settings, Take taken)
        : settings_(std::move(settings)), taken_(std::move(taken)), check_(settings_.rules),
          answers_(std::make_shared<Answers>()), thread_([this] { run(); }) {}
    ~Thread() {
        {
            const std::scoped_lock lock{mutex_};
            stop_ = true;
        }
        wake_.notify_all();
        thread_.join();
    }

    Counts counts() const {
        const std::scoped_lock lock{mutex_};
        return counts_;
    }

  private:
    /// Answers on their way; who still owes one keeps them alive.
    struct Answers {
        std::mutex mutex;
        std::deque<std::pair<std::string, v1::RequestAnswer>> waiting;  ///< with their subjects
    };

    void run() {
        while (!stopped()) {
            const auto done = work();
            if (done && !std::exchange(fault_, "").empty()) spdlog::info("requests of followers are heard again");
            if (done) continue;
            if (std::exchange(fault_, done.error().message).empty())
                spdlog::warn("requests of followers are not heard: {}", fault_);
            requests_.reset();
            std::unique_lock lock{mutex_};
            wake_.wait_for(lock, settings_.again_after, [this] { return stop_; });
        }
    }

    Result<void> work() {
        if (!engine_) {
            auto engine =
                Engine::connect(settings_.engine, "aeolis origin " + brief(settings_.rules.origin) + " requests");
            if (!engine) return engine.error();
            engine_.emplace(std::move(*engine));
        }
        if (!requests_) {
            auto requests = engine_->listen(subject_of_requests(settings_.rules.origin));
            if (!requests) return requests.error();
            requests_.emplace(std::move(*requests));
        }
        auto came = requests_->next(settings_.wait);
        if (!came) return came.error();
        if (*came && !(*came)->answer_to.empty()) take(**came);
        return send_answers();
    }

    void take(const PlainMessage& heard) {
        auto taken = check_.take(heard.octets, RequestCheck::Clock::now());
        {
            const std::scoped_lock lock{mutex_};
            ++(taken ? counts_.taken : counts_.refused);
        }
        if (!taken) {
            const auto& why = taken.error().message;
            if (told_.size() < refusal_lines_max && told_.insert(why).second)
                spdlog::warn("a follower's request is refused: {}", why);
            v1::RequestAnswer answer;
            answer.set_status(refused_status);
            answer.set_body(why);
            return give(answers_, heard.answer_to, std::move(answer));
        }
        taken_(std::move(*taken), [answers = answers_, to = heard.answer_to](v1::RequestAnswer answer) {
            give(answers, to, std::move(answer));
        });
    }

    static void give(const std::shared_ptr<Answers>& answers, const std::string& to, v1::RequestAnswer answer) {
        const std::scoped_lock lock{answers->mutex};
        if (answers->waiting.size() < answers_max) answers->waiting.emplace_back(to, std::move(answer));
    }

    Result<void> send_answers() {
        for (;;) {
            std::pair<std::string, v1::RequestAnswer> next;
            {
                const std::scoped_lock lock{answers_->mutex};
                if (answers_->waiting.empty()) return {};
                next = std::move(answers_->waiting.front());
                answers_->waiting.pop_front();
            }
            if (auto sent = engine_->send(next.first, next.second.SerializeAsString()); !sent) return sent;
        }
    }

    bool stopped() const {
        const std::scoped_lock lock{mutex_};
        return stop_;
    }

    const Settings settings_;
    const Take taken_;
    RequestCheck check_;
    const std::shared_ptr<Answers> answers_;
    std::optional<Engine> engine_;
    std::optional<Listening> requests_;  // before engine_
    std::set<std::string> told_;
    std::string fault_;
    mutable std::mutex mutex_;  // of all below
    std::condition_variable wake_;
    bool stop_ = false;
    Counts counts_;
    std::thread thread_;
};

RequestGate::RequestGate(Settings settings, Take taken)
    : thread_(std::make_unique<Thread>(std::move(settings), std::move(taken))) {}
RequestGate::~RequestGate() = default;

RequestGate::Counts RequestGate::counts() const {
    return thread_->counts();
}

}  // namespace aeolis::server::cluster
