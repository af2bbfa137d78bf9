// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/campaign.pb.h"
#include "common/result.hpp"
#include "dictionaries/dictionary.hpp"
#include "server/campaign/campaign_order.hpp"
#include "server/scenario/scenario_library.hpp"

#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

namespace aeolis::server::campaign {

/// Starts, cancels and reports the campaigns of one folder; one flies at a time. The folder holds campaign-NAME.db for
/// each, including those of `aeolis campaign`.
///
/// Thread   any but the network's: each call reads files. Cases fly on threads of their own that run only while nothing
///          else wants the processor; another thread stores the results
/// Memory   one landing per thread; a query holds no more than the touchdowns requested
/// Faults   a failed write ends the campaign, with the write's Error as its fault; stored cases stay
class CampaignManager {
  public:
    static constexpr std::uint32_t cases_max = 10'000;  ///< chosen: three hours at a case a second; a summary in 0.5 s
    static constexpr std::uint64_t touchdowns_max = 10'000;  ///< chosen: in one answer, 1 MB

    /// The arguments must outlive this.
    CampaignManager(std::filesystem::path folder, const ScenarioLibrary& scenarios,
                    const dictionary::Dictionary& dictionary);
    ~CampaignManager();  ///< abandons cases in flight within a cycle; flown cases are stored

    /// Checks a request. The Error names the field at fault.
    Result<Order> order_of(const v1::StartCampaign& request) const;
    /// Starts a campaign. The Error says why it cannot fly now: another flies, or the file belongs to another program.
    Result<v1::CampaignState> start(Order order);
    /// Cancels a campaign; its state is "cancelling" until each case has ended its cycle and one commit is done. Stored
    /// cases stay; the next start continues from them. An Error: it does not fly.
    Result<v1::CampaignState> cancel(const std::string& campaign);

    /// All campaigns with results in the folder, the oldest first.
    v1::CampaignList list();
    /// The file of a campaign; none when there is no such campaign.
    std::optional<std::filesystem::path> file_of(const std::string& campaign) const;
    /// report() and touchdowns() end with an Error soon after `stop` returns true. Errors name a file that cannot be
    /// read.
    Result<v1::CampaignReport> report(const std::filesystem::path& file, std::function<bool()> stop);
    /// Touchdowns whose place is after `place`, in order.
    Result<v1::CampaignTouchdowns> touchdowns(const std::filesystem::path& file, std::uint64_t place,
                                              std::uint64_t limit, std::function<bool()> stop);

    /// Refuses all further starts, with `reason`.
    void close(std::string reason);
    static unsigned jobs_max();

  private:
    struct Flight;
    v1::CampaignState state_of(const std::filesystem::path& file);
    bool flying() const;  ///< under mutex_

    const std::filesystem::path folder_;
    const ScenarioLibrary& scenarios_;
    const dictionary::Dictionary& dictionary_;
    std::mutex mutex_;  ///< guards the members below
    std::string closed_;
    std::unique_ptr<Flight> flight_;  ///< the last one started here
};

}  // namespace aeolis::server::campaign
