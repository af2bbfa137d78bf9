// SPDX-License-Identifier: Apache-2.0
#include "server/cluster/engine.hpp"
#include "server/cluster/run_messages.hpp"
#include "tests/server/cluster/followed.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/certificate.hpp"

#include <array>
#include <cstdint>
#include <fmt/format.h>
#include <fstream>
#include <initializer_list>
#include <openssl/evp.h>
#include <random>
#include <span>
#include <string>
#include <string_view>
#include <vector>

// Engines that are reached by TLS only, or that want to know who comes.
namespace server_cluster_engine_test {

using namespace aeolis;
using namespace aeolis::tests;

namespace {

std::string secure_url(const NatsServer& server) {
    return fmt::format("tls://localhost:{}", server.port());
}

/// An engine with a certificate, in a folder of its own.
struct SecureEngine {
    test::TemporaryFolder folder;
    std::filesystem::path certificate = folder / "engine.pem", key = folder / "engine_key.pem";
    std::optional<NatsServer> server;

    explicit SecureEngine(const std::vector<std::string>& further = {}) {
        test::write_certificate(certificate, key);
        std::vector<std::string> options{"--tls", "--tlscert", certificate.string(), "--tlskey", key.string()};
        options.insert(options.end(), further.begin(), further.end());
        server.emplace(std::move(options));
    }
    cluster::EngineAddress address(const std::filesystem::path& ca) const {
        cluster::EngineAddress address;
        address.url = secure_url(*server);
        address.ca = ca;
        return address;
    }
};

/// Why there is no connection, which is one line and tells no secret; empty: there is one.
std::string refusal(const cluster::EngineAddress& address) {
    const auto engine = Engine::connect(address, "test");
    if (engine) return {};
    CHECK_THAT(engine.error().message, !Catch::Contains("\n") && !Catch::Contains("secret"));
    return engine.error().message;
}

void write(const std::filesystem::path& file, std::string_view text) {
    std::ofstream{file} << text;
}

// ---- keys of NATS ----------------------------------------------------------------------------------------------------

using Key = std::array<std::uint8_t, 32>;

/// Ed25519, of a seed.
struct KeyPair {
    Key seed{}, of_public{};
    explicit KeyPair(std::uint32_t number) {
        std::mt19937 random{number};
        for (auto& octet : seed) octet = static_cast<std::uint8_t>(random());
        EVP_PKEY* pair = EVP_PKEY_new_raw_private_key(EVP_PKEY_ED25519, nullptr, seed.data(), seed.size());
        std::size_t size = of_public.size();
        REQUIRE(EVP_PKEY_get_raw_public_key(pair, of_public.data(), &size) == 1);
        EVP_PKEY_free(pair);
    }
    std::vector<std::uint8_t> signature(std::string_view text) const {
        EVP_PKEY* pair = EVP_PKEY_new_raw_private_key(EVP_PKEY_ED25519, nullptr, seed.data(), seed.size());
        EVP_MD_CTX* context = EVP_MD_CTX_new();
        std::vector<std::uint8_t> octets(64);
        std::size_t size = octets.size();
        REQUIRE(EVP_DigestSignInit(context, nullptr, nullptr, nullptr, pair) == 1);
        REQUIRE(EVP_DigestSign(context, octets.data(), &size, reinterpret_cast<const std::uint8_t*>(text.data()),
                               text.size()) == 1);
        EVP_MD_CTX_free(context);
        EVP_PKEY_free(pair);
        return octets;
    }
};

/// The kinds of key by their first octet (NATS ADR-3): it makes the text begin with S, U, A or O.
constexpr std::uint8_t of_seed = 18 << 3, of_user = 20 << 3, of_account = 0, of_operator = 14 << 3;

/// CRC-16/XMODEM.
std::uint16_t check_sum(std::span<const std::uint8_t> octets) {
    std::uint16_t sum = 0;
    for (const auto octet : octets) {
        sum ^= static_cast<std::uint16_t>(octet << 8);
        for (int bit = 0; bit < 8; ++bit)
            sum = static_cast<std::uint16_t>((sum & 0x8000) != 0 ? (sum << 1) ^ 0x1021 : sum << 1);
    }
    return sum;
}

/// Groups of bits as characters, without padding: base 32 (5 bits), base 64 (6 bits).
std::string in_characters(std::span<const std::uint8_t> octets, unsigned bits, std::string_view alphabet) {
    std::string text;
    unsigned held = 0, waiting = 0;
    for (const auto octet : octets) {
        held = (held << 8U | octet) & 0xFFFFU;
        for (waiting += 8; waiting >= bits; waiting -= bits)
            text += alphabet[held >> (waiting - bits) & ((1U << bits) - 1)];
    }
    if (waiting > 0) text += alphabet[held << (bits - waiting) & ((1U << bits) - 1)];
    return text;
}

std::string key_text(std::initializer_list<std::uint8_t> head, const Key& key) {
    std::vector<std::uint8_t> octets{head};
    octets.insert(octets.end(), key.begin(), key.end());
    const auto sum = check_sum(octets);
    octets.push_back(static_cast<std::uint8_t>(sum));
    octets.push_back(static_cast<std::uint8_t>(sum >> 8));
    return in_characters(octets, 5, "ABCDEFGHIJKLMNOPQRSTUVWXYZ234567");
}
std::string public_text(const KeyPair& pair, std::uint8_t kind) {
    return key_text({kind}, pair.of_public);
}
std::string seed_text(const KeyPair& pair, std::uint8_t kind) {
    return key_text({static_cast<std::uint8_t>(of_seed | kind >> 5), static_cast<std::uint8_t>((kind & 31) << 3)},
                    pair.seed);
}

std::string base64url(std::span<const std::uint8_t> octets) {
    return in_characters(octets, 6, "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_");
}
std::string base64url(std::string_view text) {
    return base64url(std::span{reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

/// A token that says what `subject` may do, signed by `by` (NATS's JWT, version 2).
std::string signed_claims(const KeyPair& by, std::uint8_t by_kind, const std::string& subject, const char* name,
                          const std::string& nats) {
    const auto claims =
        fmt::format(R"({{"jti":"of a test, {}","iat":1700000000,"iss":"{}","name":"{}","sub":"{}","nats":{}}})", name,
                    public_text(by, by_kind), name, subject, nats);
    const auto text = base64url(R"({"typ":"JWT","alg":"ed25519-nkey"})") + "." + base64url(claims);
    return text + "." + base64url(by.signature(text));
}

/// Who may be asked for by a .creds file.
std::string credentials_text(const std::string& jwt, const std::string& seed) {
    return fmt::format("-----BEGIN NATS USER JWT-----\n{}\n------END NATS USER JWT------\n\n"
                       "-----BEGIN USER NKEY SEED-----\n{}\n------END USER NKEY SEED------\n",
                       jwt, seed);
}

}  // namespace

TEST_CASE("an engine by TLS is taken by its certificate's authority, and by no other", "[cluster][R61]") {
    if (!NatsServer::present()) return;
    const SecureEngine engine;
    const auto other = engine.folder / "other.pem";
    test::write_certificate(other, engine.folder / "other_key.pem");
    const auto shown = secure_url(*engine.server) + ": ";
    CHECK(refusal(engine.address(engine.certificate)).empty());
    for (const auto& ca : {other, std::filesystem::path{}}) {
        const auto told = refusal(engine.address(ca));
        CHECK_THAT(told, Catch::StartsWith(shown) && Catch::Contains("certificate"));
    }
    CHECK_THAT(refusal(engine.address(engine.folder / "none.pem")), Catch::StartsWith("--nats-ca "));
    auto elsewhere = engine.address(engine.certificate);
    elsewhere.url = fmt::format("tls://127.0.0.1:{}", engine.server->port());  // of which the certificate says nothing
    CHECK_THAT(refusal(elsewhere), Catch::StartsWith(elsewhere.url + ": "));
}

TEST_CASE("an engine without TLS is refused where TLS is demanded, and one with TLS serves no one without it",
          "[cluster][R61]") {
    if (!NatsServer::present()) return;
    const NatsServer plain;
    cluster::EngineAddress address;
    address.url = secure_url(plain);
    CHECK_THAT(refusal(address), Catch::StartsWith(address.url + ": "));
    const SecureEngine engine;
    address.url = fmt::format("nats://localhost:{}", engine.server->port());
    address.ca = engine.certificate;
    // The engine demands TLS of it, which it then speaks, with the same authorities.
    CHECK(refusal(address).empty());
    address.ca.clear();
    CHECK_FALSE(refusal(address).empty());
}

TEST_CASE("a run is published and followed by TLS, also where the engine is killed meanwhile", "[cluster][R61]") {
    if (!NatsServer::present()) return;
    SecureEngine engine;
    test::TemporaryFolder folder;
    Origin origin{folder / "origin.db", engine.address(engine.certificate)};
    Copy copy{folder / "copy.db", engine.address(engine.certificate)};
    record_slowly(origin.archive, 200, 1ms);
    engine.server->kill();
    record_slowly(origin.archive, 100, 1ms);
    engine.server->start();
    CHECK(comes([&] { return same(origin.file(), copy.file()); }));
    CHECK_FALSE(copy.gaps());
}

TEST_CASE("an engine may want a certificate of its client", "[cluster][R61]") {
    if (!NatsServer::present()) return;
    test::TemporaryFolder folder;
    test::write_certificate(folder / "client.pem", folder / "client_key.pem");
    const SecureEngine engine{{"--tlsverify", "--tlscacert", (folder / "client.pem").string()}};
    auto address = engine.address(engine.certificate);
    CHECK_THAT(refusal(address), Catch::StartsWith(address.url + ": "));
    address.certificate = folder / "client.pem";
    address.key = folder / "client_key.pem";
    CHECK(refusal(address).empty());
    test::write_certificate(folder / "foreign.pem", folder / "foreign_key.pem");
    address.certificate = folder / "foreign.pem";
    address.key = folder / "foreign_key.pem";
    CHECK_THAT(refusal(address), Catch::StartsWith(address.url + ": "));
    address.key = folder / "none.pem";
    CHECK_THAT(refusal(address), Catch::StartsWith("--nats-certificate "));
}

TEST_CASE("users by password, token or nkey are known by it alone, and a wrong one is told without it",
          "[cluster][R61]") {
    if (!NatsServer::present()) return;
    test::TemporaryFolder folder;
    const auto connect = [&](const NatsServer& server, const std::string& before_host) {
        cluster::EngineAddress address;
        address.url = fmt::format("nats://{}127.0.0.1:{}", before_host, server.port());
        return refusal(address);
    };
    SECTION("password") {
        const NatsServer server{{"--user", "origin", "--pass", "secret_1"}};
        CHECK(connect(server, "origin:secret_1@").empty());
        CHECK_THAT(connect(server, "origin:secret_2@"), Catch::Contains("uthorization"));
        CHECK_THAT(connect(server, ""), Catch::Contains("uthorization"));
    }
    SECTION("token") {
        const NatsServer server{{"--auth", "secret_1"}};
        CHECK(connect(server, "secret_1@").empty());
        CHECK_THAT(connect(server, "secret_2@"), Catch::Contains("uthorization"));
    }
    SECTION("nkey") {
        const KeyPair user{1}, other{2};
        write(folder / "nkey.conf",
              fmt::format("authorization {{ users: [ {{ nkey: {} }} ] }}\n", public_text(user, of_user)));
        write(folder / "user.nk", seed_text(user, of_user));
        write(folder / "other.nk", seed_text(other, of_user));
        const NatsServer server{{"-c", (folder / "nkey.conf").string()}};
        cluster::EngineAddress address;
        address.url = server.url();
        address.nkey = public_text(user, of_user);
        address.nkey_seed = folder / "user.nk";
        CHECK(refusal(address).empty());
        address.nkey_seed = folder / "other.nk";  // the engine's question is not answered with the user's key
        CHECK_THAT(refusal(address), Catch::Contains("uthorization"));
        address.nkey = public_text(other, of_user);
        CHECK_THAT(refusal(address), Catch::Contains("uthorization"));
        address.nkey_seed = folder / "none.nk";
        CHECK_FALSE(refusal(address).empty());
    }
}

TEST_CASE("users by a file of credentials are those whom the account's key signs", "[cluster][R61]") {
    if (!NatsServer::present()) return;
    test::TemporaryFolder folder;
    const KeyPair authority{1}, account{2}, user{3}, stranger{4}, system{5};  // which JetStream wants
    const auto account_text = public_text(account, of_account), system_text = public_text(system, of_account);
    write(folder / "jwt.conf",
          fmt::format("operator: {}\nresolver: MEMORY\nsystem_account: {}\nresolver_preload: {{\n{}: {}\n{}: {}\n}}\n",
                      signed_claims(authority, of_operator, public_text(authority, of_operator), "authority",
                                    R"({"type":"operator","version":2})"),
                      system_text, account_text,
                      signed_claims(authority, of_operator, account_text, "account",
                                    R"({"limits":{"subs":-1,"data":-1,"payload":-1,"imports":-1,"exports":-1,)"
                                    R"("wildcards":true,"conn":-1,"leaf":-1,"mem_storage":-1,"disk_storage":-1,)"
                                    R"("streams":-1,"consumer":-1},"type":"account","version":2})"),
                      system_text,
                      signed_claims(authority, of_operator, system_text, "system",
                                    R"({"limits":{"subs":-1,"data":-1,"payload":-1,"imports":-1,"exports":-1,)"
                                    R"("wildcards":true,"conn":-1,"leaf":-1},"type":"account","version":2})")));
    const auto user_claims = [&](const KeyPair& by) {
        return signed_claims(by, of_account, public_text(user, of_user), "user",
                             R"({"subs":-1,"data":-1,"payload":-1,"type":"user","version":2})");
    };
    write(folder / "user.creds", credentials_text(user_claims(account), seed_text(user, of_user)));
    write(folder / "forged.creds", credentials_text(user_claims(stranger), seed_text(user, of_user)));
    write(folder / "stolen.creds", credentials_text(user_claims(account), seed_text(stranger, of_user)));
    const NatsServer server{{"-c", (folder / "jwt.conf").string()}};
    cluster::EngineAddress address;
    address.url = server.url();
    CHECK_THAT(refusal(address), Catch::Contains("uthorization"));
    for (const char* file : {"forged.creds", "stolen.creds"}) {
        address.credentials = folder / file;
        CHECK_THAT(refusal(address), Catch::Contains("uthorization"));
    }
    address.credentials = folder / "none.creds";
    CHECK_FALSE(refusal(address).empty());
    address.credentials = folder / "user.creds";
    CHECK(refusal(address).empty());
    Origin origin{folder / "origin.db", address};
    Copy copy{folder / "copy.db", address};
    record_slowly(origin.archive, 100, 0ms);
    CHECK(comes([&] { return same(origin.file(), copy.file()); }));
}

}  // namespace server_cluster_engine_test
