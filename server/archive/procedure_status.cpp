// SPDX-License-Identifier: Apache-2.0
#include "server/archive/procedure_status.hpp"

#include "common/check.hpp"

#include <string>
#include <zstd.h>

namespace aeolis::archive {

std::vector<std::uint8_t> packed(const v1::ProcedureStatus& status) {
    constexpr int level = 3;  // zstd's default
    const std::string octets = status.SerializeAsString();
    AEOLIS_CHECK(octets.size() <= status_octets_max);  // what is written can be read
    std::vector<std::uint8_t> made(ZSTD_compressBound(octets.size()));
    const std::size_t size = ZSTD_compress(made.data(), made.size(), octets.data(), octets.size(), level);
    AEOLIS_CHECK(ZSTD_isError(size) == 0);  // the buffer suffices
    made.resize(size);
    return made;
}

std::optional<v1::ProcedureStatus> unpacked_status(std::span<const std::uint8_t> octets) {
    const auto size = ZSTD_getFrameContentSize(octets.data(), octets.size());
    if (size == ZSTD_CONTENTSIZE_ERROR || size == ZSTD_CONTENTSIZE_UNKNOWN || size > status_octets_max) return {};
    std::string whole(static_cast<std::size_t>(size), '\0');
    v1::ProcedureStatus status;
    if (ZSTD_decompress(whole.data(), whole.size(), octets.data(), octets.size()) != whole.size() ||
        !status.ParseFromString(whole))
        return {};
    return status;
}

}  // namespace aeolis::archive
