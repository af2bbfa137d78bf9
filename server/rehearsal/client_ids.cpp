// SPDX-License-Identifier: Apache-2.0
#include "server/rehearsal/client_ids.hpp"

#include "common/time.hpp"
#include "server/archive/items.hpp"
#include "server/base/digest.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <set>
#include <string_view>

namespace aeolis::server {
namespace {

constexpr std::size_t id_length_max = 64;
constexpr std::string_view id_characters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._:-";

/// Digest of what makes two requests the same one.
std::string content_of(v1::CommandRequest request) {
    request.clear_request();
    request.clear_client_id();
    request.clear_run();
    request.clear_dry_run();
    const auto text = request.SerializeAsString();
    Digest digest;
    digest.add({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
    return digest.text();
}

bool has_id(const v1::CommandRequest& request) {
    return !request.client_id().empty() && request.action().empty();
}

}  // namespace

Result<void> check_client_ids(std::span<const v1::CommandRequest> requests) {
    std::set<std::string_view> ids;
    for (const auto& request : requests) {
        const std::string& id = request.client_id();
        if (id.empty()) continue;
        if (!request.action().empty()) return Error{"client_id: it names a new command, not an action on one"};
        if (id.size() > id_length_max || id.find_first_not_of(id_characters) != std::string::npos)
            return Error{fmt::format("client_id: 1 to {} of A-Z a-z 0-9 . _ : - are wanted", id_length_max)};
        if (!ids.insert(id).second) return Error{fmt::format("client_id: '{}' is given to two commands", id)};
    }
    return {};
}

void ClientIds::accepted(const v1::CommandRequest& request, std::uint64_t number) {
    if (!has_id(request)) return;
    sent_.emplace(request.client_id(), Sent{number, content_of(request), {}});
    ids_.emplace(number, request.client_id());
}

void ClientIds::note(const archive::StageRecord& stage) {
    const auto id = ids_.find(stage.command);
    if (id == ids_.end()) return;
    auto& sent = sent_.at(id->second);
    sent.fate = std::move(*archive::to_item(stage).mutable_command_stage());
    sent.fate_at = stage.ert;
}

const ClientIds::Sent* ClientIds::find(const v1::CommandRequest& request) const {
    if (!has_id(request)) return nullptr;
    const auto found = sent_.find(request.client_id());
    return found == sent_.end() ? nullptr : &found->second;
}

std::optional<v1::CommandReply> ClientIds::reply_to(const v1::CommandRequest& request) const {
    const auto* sent = find(request);
    if (sent == nullptr) return std::nullopt;
    v1::CommandReply reply;
    reply.set_request(request.request());
    reply.set_dry_run(request.dry_run());
    if (sent->content != content_of(request)) {
        reply.set_reason(fmt::format("client_id: '{}' is command {} of this run, which is another or another's: choose "
                                     "a new one",
                                     request.client_id(), sent->number));
        return reply;
    }
    reply.set_accepted(true);
    reply.set_command(sent->number);
    reply.set_repeated(true);
    *reply.mutable_fate() = sent->fate;
    reply.set_fate_us(sent->fate_at.microseconds);
    return reply;
}

}  // namespace aeolis::server
