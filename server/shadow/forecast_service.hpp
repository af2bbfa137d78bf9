// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/what_if.pb.h"
#include "common/result.hpp"
#include "dictionaries/dictionary.hpp"
#include "server/archive/forecasts.hpp"
#include "server/archive/reader.hpp"
#include "server/rehearsal/rehearsal.hpp"
#include "server/shadow/forecast.hpp"

#include <array>
#include <atomic>
#include <condition_variable>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace aeolis::server::shadow {

/// A forecast that was asked for and read: nothing in it is refused any more before it flies.
struct ReadForecast {
    archive::FlownRun run;
    std::uint64_t cycle = 0;  ///< of the run's landing, at which the cases begin
    bool goes_on = false;     ///< the run: what it received last may not be stored yet
    bool now = false;         ///< the instant is where it is now: what was taken there counts
    simulation::Scenario scenario;
    Assumption assumption;
    ForecastOrder order;
    std::vector<std::string> assumed;  ///< in words
    archive::ForecastRecord record;    ///< to be kept
};

/// Reads a request for a run. The Error names the field at fault, or says why no forecast is possible of it.
/// @param state  with clocks: the run goes on
Result<ReadForecast> read_forecast(const v1::ForecastRequest& request, const v1::RunState& state,
                                   archive::Reader& reader);

/// Flies forecasts, one after another in the order asked for, on threads that run only while nothing else wants the
/// processor. Each flies its run again up to the instant asked for, and holds what ground receives against the archive.
///
/// In       forecasts that were read, and are kept already     Out   `keep`: the same with their result
/// Thread   one of its own, which calls `keep`; all others may be called from any
/// Memory   one landing and one a processor; results until they are durable
/// Faults   a forecast that cannot be flown is kept as failed, with its reason. What cannot be kept now is tried again
///          each second, and told from here meanwhile
class ForecastService {
  public:
    static constexpr std::size_t waiting_max =
        8;  ///< of each kind, so that neither shuts the other out; chosen: minutes

    /// Stores a record; calls `done` later with whether it is durable, on any thread. False: not taken.
    using Keep = std::function<bool(const archive::ForecastRecord&, std::function<void(bool durable)> done)>;
    /// The dictionary must outlive this. `file`: the archive with the runs.
    ForecastService(const dictionary::Dictionary& dictionary, std::filesystem::path file, Keep keep);
    ForecastService(const ForecastService&) = delete;
    ForecastService& operator=(const ForecastService&) = delete;
    ~ForecastService();  ///< abandons what flies and what waits

    /// Takes a place for a forecast that is about to be kept; the Error says that there is none.
    Result<void> reserve(bool truth);
    /// Queues a forecast, whose record has its number, at the place that was taken; none: gives the place back.
    void fill(bool truth, std::optional<ReadForecast> forecast);
    /// Ends a forecast that flies or waits. False: it does neither.
    bool cancel(archive::RunId run, std::uint64_t number);
    /// The forecast as it is now: with its progress, or its end that is not durable yet. One that should fly and is not
    /// known here was abandoned.
    v1::Forecast now(const archive::ForecastRecord& record) const;

  private:
    /// What the callbacks of `keep` may touch, also once this is gone.
    struct Ended {
        struct Each {
            archive::ForecastRecord record;
            bool on_its_way = false;  ///< to the archive
        };
        std::mutex mutex;
        std::vector<Each> all;  ///< under mutex
    };

    void work();
    std::string fly_to(ReadForecast& forecast, Rehearsal& rehearsal, HeardFlight& heard);
    void fly(ReadForecast& forecast);
    void end(archive::ForecastRecord record);
    void keep_ended();

    const dictionary::Dictionary& dictionary_;
    std::filesystem::path file_;
    Keep keep_;
    std::shared_ptr<Ended> ended_ = std::make_shared<Ended>();
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::array<std::size_t, 2> reserved_{};          ///< under mutex_; by telemetry, from the truth
    std::deque<ReadForecast> waiting_;               ///< under mutex_
    std::optional<archive::ForecastRecord> flying_;  ///< under mutex_
    ForecastProgress progress_;                      ///< under mutex_
    bool cancelled_ = false;                         ///< under mutex_; the one that flies
    bool over_ = false;                              ///< under mutex_; the service
    std::atomic<bool> stop_{false};                  ///< the one that flies ends
    std::thread thread_;
};

}  // namespace aeolis::server::shadow
