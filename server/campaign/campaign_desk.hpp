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

/// The campaigns of one folder, campaign-NAME.db each, those of `aeolis campaign` too: one at a time flies, all can be
/// looked at.
///
/// Thread   any but the network's: each call reads files. What flies has threads of its own that run only where nobody
///          else wants the processor, and one beside them keeps
/// Memory   a landing a thread; a look at a campaign keeps its touchdowns that were asked for, no more
/// Faults   a disk that does not take the results ends the campaign, with that as its fault; what is kept stays
class CampaignDesk {
  public:
    static constexpr std::uint32_t cases_max =
        10'000;  ///< ours: at a case a second three hours, and a summary in half a second
    static constexpr std::uint64_t touchdowns_max = 10'000;  ///< ours: of one answer, 1 MB

    /// What is given must outlive this.
    CampaignDesk(std::filesystem::path folder, const ScenarioLibrary& scenarios,
                 const dictionary::Dictionary& dictionary);
    ~CampaignDesk();  ///< what flies is abandoned within a cycle, what is flown is kept

    /// An Error names what in the request makes no sense.
    Result<Order> order_of(const v1::StartCampaign& request) const;
    /// An Error names why it cannot be flown now: another flies, or the file belongs to another program.
    Result<v1::CampaignState> start(Order order);
    /// It is over within a cycle of each case and one commit, and "cancelling" until then. The cases that are kept
    /// stay, and the next start goes on with them. An Error: it does not fly.
    Result<v1::CampaignState> cancel(const std::string& campaign);

    v1::CampaignList list();
    /// None: there is no such campaign.
    std::optional<std::filesystem::path> file_of(const std::string& campaign) const;
    /// Both end with an Error soon after `stop` says so. Errors name a file that cannot be read.
    Result<v1::CampaignReport> report(const std::filesystem::path& file, std::function<bool()> stop);
    /// Those that came after `place`, in that order.
    Result<v1::CampaignTouchdowns> touchdowns(const std::filesystem::path& file, std::uint64_t place,
                                              std::uint64_t limit, std::function<bool()> stop);

    /// From now on none can be started, because of `reason`.
    void close(std::string reason);
    static unsigned jobs_max();

  private:
    struct Flight;
    v1::CampaignState state_of(const std::filesystem::path& file);
    bool flying() const;  ///< under mutex_

    const std::filesystem::path folder_;
    const ScenarioLibrary& scenarios_;
    const dictionary::Dictionary& dictionary_;
    std::mutex mutex_;  ///< of what follows
    std::string closed_;
    std::unique_ptr<Flight> flight_;  ///< the last one that was started here
};

}  // namespace aeolis::server::campaign
