// SPDX-License-Identifier: Apache-2.0
#include "server/cluster/run_messages.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <utility>

namespace aeolis::server::cluster {

std::vector<std::string> messages_of(const archive::RunStep& step, v1::RunRows head) {
    const auto octets = archive::packed(step.rows);
    const auto pieces = std::max<std::size_t>((octets.size() + piece_octets_max - 1) / piece_octets_max, 1);
    head.set_dictionary(step.dictionary);
    *head.mutable_before() = step.before;
    *head.mutable_after() = step.after;
    head.set_pieces(static_cast<std::uint32_t>(pieces));
    std::vector<std::string> messages;
    messages.reserve(pieces);
    for (std::size_t piece = 0; piece < pieces; ++piece) {
        head.set_piece(static_cast<std::uint32_t>(piece));
        head.set_octets(octets.substr(piece * piece_octets_max, piece_octets_max));
        messages.push_back(head.SerializeAsString());
    }
    return messages;
}

Result<v1::RunRows> run_rows_of(std::string_view octets) {
    v1::RunRows message;
    if (!message.ParseFromArray(octets.data(), static_cast<int>(octets.size())) || message.run() == 0 ||
        message.pieces() == 0 || message.piece() >= message.pieces())
        return Error{"a message that is none of an origin"};
    return message;
}

Result<std::optional<TravelledStep>> StepJoiner::join(v1::RunRows message) {
    auto& begun = begun_[message.run()];
    const bool fits =
        message.piece() == 0 || (message.piece() == begun.next && message.pieces() == begun.step.head.pieces() &&
                                 archive::equal(message.after(), begun.step.head.after()));
    if (!fits) {
        begun = {};
        return Error{fmt::format("run {}: a piece of a step without the one before", message.run())};
    }
    if (message.piece() == 0) begun = {};
    begun.step.octets += message.octets();
    begun.next = message.piece() + 1;
    const bool last = begun.next == message.pieces();
    if (begun.step.octets.size() > archive::row_set_octets_max) {
        begun = {};
        return Error{
            fmt::format("run {}: a step of more than {} MB", message.run(), archive::row_set_octets_max >> 20U)};
    }
    message.clear_octets();
    if (message.piece() == 0) begun.step.head = std::move(message);
    if (!last) return std::optional<TravelledStep>{};
    return std::optional{std::exchange(begun, {}).step};
}

}  // namespace aeolis::server::cluster
