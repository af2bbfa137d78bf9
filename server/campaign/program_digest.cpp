// SPDX-License-Identifier: Apache-2.0
#include "server/campaign/program_digest.hpp"

#include "server/base/digest.hpp"

#include <fstream>
#include <vector>

namespace aeolis::server::campaign {

Result<std::string> program_digest() {
    std::ifstream program{"/proc/self/exe", std::ios::binary};
    std::vector<char> piece(1 << 20);
    Digest digest;
    while (program.read(piece.data(), static_cast<std::streamsize>(piece.size())) || program.gcount() > 0)
        digest.add({reinterpret_cast<const std::uint8_t*>(piece.data()), static_cast<std::size_t>(program.gcount())});
    if (!program.eof()) return Error{"/proc/self/exe: cannot be read"};
    return digest.text();
}

}  // namespace aeolis::server::campaign
