// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/cluster.pb.h"
#include "common/result.hpp"
#include "server/campaign/campaign_store.hpp"
#include "server/campaign/case_result.hpp"

#include <string>

// The messages between a campaign and its workers, and their subjects (docs/scale.md).
namespace aeolis::server::cluster {

inline constexpr const char* campaign_stream = "AEOLIS_CAMPAIGNS";   ///< the newest CampaignOrder of each
inline constexpr const char* case_stream = "AEOLIS_CASES";           ///< CaseOrder, until flown
inline constexpr const char* answer_stream = "AEOLIS_CASE_ANSWERS";  ///< CaseAnswer, until stored

inline constexpr std::uint64_t tries_max = 3;  ///< a case that was given this often without an answer is set aside

/// The subjects of one campaign. `kind` stands for what must be equal to fly alike: program and dictionary.
struct CampaignSubjects {
    CampaignSubjects(const std::string& kind, const std::string& campaign);

    std::string order, cases, answers;
    std::string case_consumer, answer_consumer;  ///< their names
};

/// Eight octets of SHA-256 over program and dictionary, in hexadecimal digits.
std::string kind_of(const campaign::Identity& identity);
/// The campaign that an order's subject names; empty: it is not of this kind.
std::string campaign_of(const std::string& subject, const std::string& kind);

v1::FlownCase message_of(const campaign::CaseResult& result);
/// Reads the result from an answer. The Error names a value that no result of this program has.
Result<campaign::CaseResult> result_of(const v1::CaseAnswer& answer);

}  // namespace aeolis::server::cluster
