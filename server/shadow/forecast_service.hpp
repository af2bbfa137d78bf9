// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/forecast.pb.h"
#include "common/result.hpp"
#include "dictionaries/dictionary.hpp"
#include "server/archive/forecasts.hpp"
#include "server/archive/records.hpp"
#include "server/shadow/forecast.hpp"

#include <atomic>
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

namespace aeolis::server::shadow {

/// A forecast that was asked for and read: nothing in it is refused any more before it flies.
struct ReadForecast {
    archive::FlownRun run;
    std::uint64_t cycle = 0;  ///< of the run's landing, at which the cases begin
    simulation::Scenario scenario;
    Assumption assumption;
    ForecastOrder order;
    std::vector<std::string> assumed;  ///< in words
    archive::ForecastRecord record;    ///< to be kept
};

/// Reads a request. The Error names the field at fault, or says why no forecast is possible of this run.
Result<ReadForecast> read_forecast(const v1::ForecastRequest& request, const v1::RunState& state,
                                   archive::FlownRun run);

/// Flies forecasts, one after another in the order asked for, on threads that run only while nothing else wants the
/// processor. Each flies its run again from the archive up to the instant asked for.
///
/// In       forecasts that were read, and are kept already     Out   `keep`: the same with their result
/// Thread   one of its own, which calls `keep`; all others may be called from any
/// Memory   one landing and one a processor
/// Faults   a forecast that cannot be flown is kept as failed, with its reason
class ForecastService {
  public:
    static constexpr std::size_t waiting_max = 8;  ///< chosen: some minutes of work

    using Keep = std::function<void(const archive::ForecastRecord&)>;
    /// The dictionary must outlive this.
    ForecastService(const dictionary::Dictionary& dictionary, Keep keep);
    ForecastService(const ForecastService&) = delete;
    ForecastService& operator=(const ForecastService&) = delete;
    ~ForecastService();  ///< abandons what flies and what waits

    /// Why no further forecast is taken now; empty: one is.
    std::string full() const;
    /// Queues a forecast, whose record has its number.
    void add(ReadForecast forecast);
    /// Ends a forecast that flies or waits. False: it does neither.
    bool cancel(archive::RunId run, std::uint64_t number);
    /// The forecast as it is now: state and progress of one that flies or waits here; one that should and does not was
    /// abandoned.
    v1::Forecast now(const archive::ForecastRecord& record) const;

  private:
    void work();
    void fly(ReadForecast& forecast);

    const dictionary::Dictionary& dictionary_;
    Keep keep_;
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<ReadForecast> waiting_;               ///< under mutex_
    std::optional<archive::ForecastRecord> flying_;  ///< under mutex_
    ForecastProgress progress_;                      ///< under mutex_
    bool cancelled_ = false, flown_ = false;         ///< under mutex_; the one that flies
    bool over_ = false;                              ///< under mutex_; the service
    std::atomic<bool> stop_{false};                  ///< the one that flies ends
    std::thread thread_;
};

}  // namespace aeolis::server::shadow
