// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/support/catch.hpp"

#include <cstdio>
#include <filesystem>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/x509v3.h>
#include <string>

namespace aeolis::test {

/// Writes a certificate for localhost, signed by itself and good for an hour, and its key.
inline void write_certificate(const std::filesystem::path& certificate, const std::filesystem::path& key) {
    EVP_PKEY* pair = EVP_EC_gen("P-256");
    X509* made = X509_new();
    X509_set_version(made, 2);
    ASN1_INTEGER_set(X509_get_serialNumber(made), 1);
    X509_gmtime_adj(X509_getm_notBefore(made), -60);
    X509_gmtime_adj(X509_getm_notAfter(made), 3600);
    X509_set_pubkey(made, pair);
    const std::string host = "localhost";
    X509_NAME_add_entry_by_txt(X509_get_subject_name(made), "CN", MBSTRING_ASC,
                               reinterpret_cast<const unsigned char*>(host.c_str()), -1, -1, 0);
    X509_set_issuer_name(made, X509_get_subject_name(made));
    auto* names = X509V3_EXT_conf_nid(nullptr, nullptr, NID_subject_alt_name, "DNS:localhost");
    X509_add_ext(made, names, -1);
    REQUIRE(X509_sign(made, pair, EVP_sha256()) != 0);
    const auto write = [](const std::filesystem::path& file, auto&& put) {
        std::FILE* out = std::fopen(file.c_str(), "w");
        REQUIRE(out != nullptr);
        CHECK(put(out) == 1);
        std::fclose(out);
    };
    write(certificate, [&](std::FILE* out) { return PEM_write_X509(out, made); });
    write(key, [&](std::FILE* out) { return PEM_write_PrivateKey(out, pair, nullptr, nullptr, 0, nullptr, nullptr); });
    X509_EXTENSION_free(names);
    X509_free(made);
    EVP_PKEY_free(pair);
}

}  // namespace aeolis::test
