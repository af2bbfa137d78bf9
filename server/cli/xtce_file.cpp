// SPDX-License-Identifier: Apache-2.0
#include "server/cli/xtce_file.hpp"

#include "common/crc.hpp"
#include "server/base/log_line.hpp"
#include "server/cli/shipped_paths.hpp"
#include "telemetry/container_decoder.hpp"

#include <fmt/format.h>
#include <fstream>
#include <iterator>
#include <vector>

namespace aeolis::server {
namespace {

constexpr std::uintmax_t text_octets_max = std::uintmax_t{256} << 20U;  // chosen
constexpr std::size_t findings_shown_max = 200;                         // chosen: a person reads no more

void print_findings(const std::vector<dictionary::Finding>& findings) {
    for (std::size_t i = 0; i < findings.size() && i < findings_shown_max; ++i)
        print_line(stderr, fmt::format("{}:{}: {}", findings[i].file, findings[i].line, findings[i].message));
    if (findings.size() > findings_shown_max)
        print_line(stderr, fmt::format("and {} more", findings.size() - findings_shown_max));
}

}  // namespace

Result<std::string> text_of_file(const std::filesystem::path& path) {
    std::error_code error;
    const auto size = std::filesystem::file_size(path, error);
    std::ifstream in{path, std::ios::binary};
    if (error || !in) return Error{path.string() + " cannot be read"};
    if (size > text_octets_max)
        return Error{path.string() + " is larger than " + std::to_string(text_octets_max) + " octets"};
    return std::string{std::istreambuf_iterator<char>{in}, {}};
}

std::string MissionXtce::text() const {
    std::string names;
    for (const auto& file : files) names += (names.empty() ? "" : " and ") + file.filename().string();
    return names;
}

XtceFile read_xtce(const MissionXtce& xtce) {
    std::vector<dictionary::xtce::XtceText> texts;
    std::string all_text;
    for (const auto& file : xtce.files) {
        auto text = text_of_file(file);
        if (!text) return {std::nullopt, failed(text.error().message, 2)};
        all_text += *text;
        texts.push_back({file.string(), std::move(*text)});
    }
    // Packets decoded otherwise are those of another dictionary.
    if (xtce.leading_size != MissionXtce{}.leading_size) all_text += "\nleading-size " + xtce.leading_size;
    if (!xtce.time.empty()) all_text += "\ntime " + xtce.time;
    std::vector<dictionary::Finding> all;
    XtceFile file{dictionary::xtce::read_packet_model(
        texts, all, {.leading_size_unit_bits = xtce.leading_size == "octets" ? 8U : 1U})};
    print_findings(all);
    file.findings = all.size();
    if (!file.model) {
        file.exit_code = 1;
        return file;
    }
    const auto begins = telemetry::ContainerDecoder::root_of(*file.model, xtce.root);
    if (!begins) return {std::nullopt, failed(fmt::format("{}: {} (--root)", xtce.text(), begins.error().message), 2)};
    file.model->root = *begins;
    if (telemetry::ContainerDecoder::roots_of(*file.model).size() > 1)
        all_text += "\nroot " + file.model->containers[*begins].path;
    file.id = crc16(std::vector<std::uint8_t>{all_text.begin(), all_text.end()});
    if (!xtce.time.empty()) {
        auto time = telemetry::TimeSource::parse(*file.model, xtce.time);
        if (!time) return {std::nullopt, failed(fmt::format("--time: {}", time.error().message), 2)};
        file.time = std::move(*time);
    }
    return file;
}

}  // namespace aeolis::server
