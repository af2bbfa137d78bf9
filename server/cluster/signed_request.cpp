// SPDX-License-Identifier: Apache-2.0
#include "server/cluster/signed_request.hpp"

#include "server/access/secrets.hpp"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <fstream>
#include <iterator>
#include <unistd.h>
#include <utility>

namespace aeolis::server::cluster {
namespace {

constexpr std::size_t seed_digits = 64;  // of 32 octets
constexpr std::size_t shown_digits = 8;  // of a key, in sentences

/// In front of what is signed, so that a signature of something else is none of a request.
std::string signed_octets(const std::string& request) {
    return "aeolis follower request 1\n" + request;
}

}  // namespace

Result<std::string> read_seed(const std::filesystem::path& file) {
    using std::filesystem::perms;
    std::error_code error;
    const auto mode = std::filesystem::status(file, error).permissions();
    if (error) return Error{fmt::format("{}: {}", file.string(), error.message())};
    if ((mode & (perms::group_all | perms::others_all)) != perms::none)
        return Error{fmt::format("{}: others may read or write this key: chmod 600, or make a new one", file.string())};
    std::ifstream in{file, std::ios::binary};
    std::string digits{std::istreambuf_iterator<char>{in}, {}};
    if (digits.ends_with('\n')) digits.pop_back();
    if (digits.size() != seed_digits || octets_of_hexadecimal(digits).empty())
        return Error{fmt::format("{}: not a key that aeolis accounts follower-key made", file.string())};
    return octets_of_hexadecimal(digits);
}

Result<std::string> make_key(const std::filesystem::path& file) {
    const auto seed = new_signing_seed();
    const auto text = hexadecimal(seed) + '\n';
    const int out = ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
    const bool written =
        out >= 0 && ::write(out, text.data(), text.size()) == static_cast<ssize_t>(text.size()) && ::fsync(out) == 0;
    const int why = errno;
    if (out >= 0) ::close(out);
    if (!written) return Error{fmt::format("{}: {}", file.string(), std::strerror(why))};
    return hexadecimal(public_key_of(seed));
}

std::string signed_message(const v1::FollowerRequest& request, const std::string& seed) {
    v1::SignedRequest message;
    message.set_request(request.SerializeAsString());
    message.set_key(public_key_of(seed));
    message.set_signature(signature_of(seed, signed_octets(message.request())));
    return message.SerializeAsString();
}

Result<RequestCheck::Taken> RequestCheck::take(const std::string& octets, Clock::time_point now) {
    v1::SignedRequest message;
    if (!message.ParseFromString(octets)) return Error{"not a request of a follower"};
    Taken taken;
    taken.key = hexadecimal(message.key());
    const auto name = rules_.follower(taken.key);
    if (!name)
        return Error{fmt::format("the key {:.{}}… is of none of this server's followers (aeolis accounts add-follower)",
                                 taken.key, shown_digits)};
    taken.follower = *name;
    const auto refused = [&](const std::string& why) { return Error{fmt::format("follower {}: {}", *name, why)}; };
    if (!has_signed(message.key(), signed_octets(message.request()), message.signature()))
        return refused("a request that its key has not signed");
    if (!taken.request.ParseFromString(message.request()) || taken.request.number().size() != request_number_octets)
        return refused("not a request");
    if (taken.request.origin() != rules_.origin) return refused("a request for another archive");
    if (!rules_.said(taken.request.publisher(), taken.request.heard()))
        return refused("a request from before this server started, or from too long ago: it has not heard this server");
    while (!kept_.empty() && now - kept_.front().first > kept_for) {
        numbers_.erase(kept_.front().second);
        kept_.pop_front();
    }
    const auto number = message.key() + taken.request.number();
    if (numbers_.contains(number)) return refused("a request that was taken before");
    if (numbers_.size() >= kept_max) return refused("too many requests in a minute");
    numbers_.insert(number);
    kept_.emplace_back(now, number);
    return taken;
}

}  // namespace aeolis::server::cluster
