// SPDX-License-Identifier: Apache-2.0
// PDUs of any octets to both ends of a file delivery: what can be read is written again with the same meaning, neither
// end says what cannot be read, and nothing is written twice or outside the file. A PDU is behind an octet of length;
// where that is even, its header is replaced by that of the transaction.
#include "flight/file_delivery/cfdp_source.hpp"
#include "telemetry/cfdp_receiver.hpp"

#include <algorithm>
#include <cstdlib>
#include <vector>

namespace {

using namespace aeolis;

void check_same_when_written(const cfdp::Pdu& pdu) {
    if (pdu.header.source > 0xFFFF || pdu.header.destination > 0xFFFF || pdu.header.sequence > 0xFFFFFFFF) return;
    std::vector<std::uint8_t> octets(cfdp::octets_of(pdu));
    cfdp::write(pdu, octets);
    const auto again = cfdp::read(octets);
    if (!again || again->header != pdu.header || again->content.index() != pdu.content.index()) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const std::vector<std::uint8_t> file(5000, 0x5A);
    flight::CfdpSource source{{76, 1, 9, 5000, 700}, "recording"};
    telemetry::CfdpReceiver receiver{*telemetry::reception_of({.source = 76, .sequence = 9, .destination = 1})};
    std::vector<std::uint8_t> out(source.pdu_octets_max());
    std::uint64_t written = 0;
    for (std::span<const std::uint8_t> rest{data, size}; !rest.empty();) {
        const std::size_t now = std::min<std::size_t>(rest[0], rest.size() - 1);
        const bool ours = rest[0] % 2 == 0;
        const auto pdu = cfdp::read(rest.subspan(1, now));
        rest = rest.subspan(1 + now);
        if (const std::size_t sent = source.next(file, out); sent > 0 && !cfdp::read(std::span{out}.first(sent)))
            std::abort();
        if (!pdu) continue;
        check_same_when_written(*pdu);
        cfdp::Pdu given = *pdu;
        if (ours) given.header = {.source = 76, .sequence = 9, .destination = 1};
        for (const auto& write : receiver.on(given)) written += write.octets.size();
        given.header.toward_sender = true;
        source.on(given);
        while (const auto answer = receiver.next())
            if (!cfdp::read(*answer)) std::abort();
    }
    if (written != telemetry::received_octets(receiver.state())) std::abort();
    return 0;
}
