// SPDX-License-Identifier: Apache-2.0
#include "server/api/raw_export.hpp"

#include "server/base/pcap.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace aeolis::server {

Result<RawExport> RawExport::begin(archive::Reader& reader, archive::RunId run, archive::RawQuery query,
                                   const std::string& format) {
    if (format != "bin" && format != "pcap") return Error{"format: '" + format + "' is neither bin nor pcap"};
    RawExport wanted;
    wanted.run_ = run;
    wanted.pcap_ = format == "pcap";
    const auto links = reader.raw_links(run);
    if (!links) return links.error();
    for (const auto& each : *links) {
        wanted.links_.push_back(each.link);
        if (each.stream && !query.packets) wanted.streams_.insert(each.link);
        if (query.link.empty() || query.link == each.link) wanted.octets_removed_ += each.first;
    }
    if (!query.packets) {
        if (links->empty()) return Error{fmt::format("no octets of links are kept of run {}", run.value)};
        if (!query.link.empty() && std::ranges::find(wanted.links_, query.link) == wanted.links_.end())
            return Error{fmt::format("link: run {} has no octets of '{}'; it has those of {}", run.value, query.link,
                                     fmt::join(wanted.links_, ", "))};
        if (!wanted.pcap_ && query.link.empty() && links->size() > 1)
            return Error{
                fmt::format("link: one of {}: the octets of several make no stream", fmt::join(wanted.links_, ", "))};
    }
    if (query.packets && !query.link.empty() && std::ranges::find(wanted.links_, query.link) == wanted.links_.end()) {
        const auto any = reader.raw(run, {.packets = true, .link = query.link}, {});
        if (!any) return any.error();
        if (any->pieces.empty())
            return Error{fmt::format("link: run {} has no packets of '{}'{}{}", run.value, query.link,
                                     links->empty() ? "" : "; it has octets of ", fmt::join(wanted.links_, ", "))};
    }
    if (!query.link.empty()) wanted.links_ = {query.link};
    wanted.query_ = std::move(query);
    return wanted;
}

std::string RawExport::head() const {
    return pcap_ ? pcap::head() : std::string{};
}

Result<std::optional<std::string>> RawExport::page(archive::Reader& reader) {
    if (done_) return std::optional<std::string>{};
    auto page = reader.raw(run_, query_, after_);
    if (!page) return page.error();
    std::string text;
    for (const auto& piece : page->pieces) {
        if (!pcap_) {
            text.append(piece.octets.begin(), piece.octets.end());
            continue;
        }
        auto link = std::ranges::find(links_, piece.link);
        if (link == links_.end()) link = links_.insert(links_.end(), piece.link);
        pcap::append(text, piece.ert, static_cast<std::uint16_t>(pcap::first_port + (link - links_.begin())),
                     piece.octets, streams_.contains(piece.link));
    }
    done_ = page->last;
    if (!page->pieces.empty()) after_ = std::move(page->pieces.back());
    return std::optional{std::move(text)};
}

}  // namespace aeolis::server
