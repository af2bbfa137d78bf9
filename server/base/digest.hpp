// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace aeolis::server {

/// SHA-256 (libcrypto) of octets given piece by piece; identifies everything that a run recorded.
class Digest {
  public:
    Digest();
    ~Digest();
    Digest(const Digest&) = delete;
    Digest& operator=(const Digest&) = delete;

    void add(std::span<const std::uint8_t> octets);
    /// The hexadecimal digest of everything added so far; more may be added after.
    std::string text() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace aeolis::server
