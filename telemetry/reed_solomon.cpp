// SPDX-License-Identifier: Apache-2.0
#include "telemetry/reed_solomon.hpp"

#include "common/check.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <optional>

namespace aeolis::telemetry {
namespace {

constexpr unsigned order = 255;               // of the multiplicative group
constexpr unsigned field_polynomial = 0x187;  // x^8 + x^7 + x^2 + x + 1
constexpr unsigned root_step = 11;            // the code's roots are powers of alpha^11
constexpr unsigned middle_root = 128;         // from 128 - E to 127 + E
constexpr std::size_t symbols_max = ReedSolomonCode::word_symbols_max;
constexpr std::size_t checks_max = 32;

/// GF(2^8) by logarithms to the base alpha. `power` is long enough for the sum of two logarithms.
struct Field {
    std::array<std::uint8_t, 2 * order> power{};
    std::array<std::uint8_t, order + 1> log{};  // of 0: not defined

    constexpr Field() {
        unsigned value = 1;
        for (unsigned i = 0; i < order; ++i) {
            power[i] = power[i + order] = static_cast<std::uint8_t>(value);
            log[value] = static_cast<std::uint8_t>(i);
            value <<= 1U;
            if (value > order) value ^= field_polynomial;
        }
    }
    constexpr std::uint8_t times(std::uint8_t a, std::uint8_t b) const {
        return a == 0 || b == 0 ? std::uint8_t{0} : power[std::size_t{log[a]} + log[b]];
    }
    constexpr std::uint8_t over(std::uint8_t a, std::uint8_t b) const {
        return a == 0 ? std::uint8_t{0} : power[std::size_t{log[a]} + order - log[b]];
    }
};
constexpr Field gf;

/// alpha^(11 n)
constexpr unsigned root_log(unsigned n) {
    return root_step * n % order;
}

/// Representation of symbols: bit i of a symbol in the dual basis, the first sent being bit 0, is the trace of
/// alpha^(117 i) times it. [ccsds-131.0-b-5, annex F]
struct Bases {
    std::array<std::uint8_t, order + 1> dual{}, conventional{};

    constexpr Bases() {
        constexpr unsigned basis_log = 117, bits = 8;
        for (unsigned symbol = 1; symbol <= order; ++symbol) {
            unsigned sent = 0;
            for (unsigned i = 0; i < bits; ++i) {
                unsigned log = (gf.log[symbol] + basis_log * i) % order, trace = 0;
                for (unsigned term = 0; term < bits; ++term, log = 2 * log % order) trace ^= gf.power[log];
                sent = 2 * sent + (trace & 1U);
            }
            dual[symbol] = static_cast<std::uint8_t>(sent);
            conventional[sent] = static_cast<std::uint8_t>(symbol);
        }
    }
};
constexpr Bases bases;

/// A remainder by the code's generator: coefficients from the highest power down, eight in a word.
template <std::size_t checks>
using Remainder = std::array<std::uint64_t, checks / 8>;

/// What the generator without its highest power is when multiplied by each symbol.
template <std::size_t checks>
struct Division {
    std::array<Remainder<checks>, order + 1> multiples{};

    constexpr Division() {
        std::array<std::uint8_t, checks + 1> generator{1};  // from the lowest power up
        for (unsigned n = 0; n < checks; ++n) {
            const auto root = gf.power[root_log(middle_root - checks / 2 + n)];
            for (std::size_t i = n + 1; i > 0; --i)
                generator[i] = static_cast<std::uint8_t>(generator[i - 1] ^ gf.times(root, generator[i]));
            generator[0] = gf.times(root, generator[0]);
        }
        for (unsigned symbol = 0; symbol <= order; ++symbol)
            for (std::size_t i = 0; i < checks; ++i) {
                auto& word = multiples[symbol][i / 8];
                word = word << 8U | gf.times(static_cast<std::uint8_t>(symbol), generator[checks - 1 - i]);
            }
    }
};
template <std::size_t checks>
constexpr Division<checks> division;

/// The remainder of a whole word; 0 when it is free of errors.
template <std::size_t checks>
Remainder<checks> remainder_of(std::span<const std::uint8_t> word) {
    Remainder<checks> rest{};
    for (const std::uint8_t symbol : word.first(word.size() - checks)) {
        const auto& multiple = division<checks>.multiples[(rest[0] >> 56U) ^ symbol];
        for (std::size_t i = 0; i + 1 < rest.size(); ++i) rest[i] = (rest[i] << 8U | rest[i + 1] >> 56U) ^ multiple[i];
        rest.back() = rest.back() << 8U ^ multiple.back();
    }
    const auto sent = word.last(checks);
    for (std::size_t i = 0; i < checks; ++i) rest[i / 8] ^= std::uint64_t{sent[i]} << (56U - 8U * (i % 8));
    return rest;
}

/// A polynomial, from the lowest power up.
using Polynomial = std::array<std::uint8_t, checks_max + 1>;

template <std::size_t checks>
Polynomial syndromes_of(const Remainder<checks>& rest) {
    Polynomial syndromes{};
    for (unsigned n = 0; n < checks; ++n) {
        const auto root = gf.power[root_log(middle_root - checks / 2 + n)];
        std::uint8_t sum = 0;
        for (std::size_t i = 0; i < checks; ++i)
            sum = static_cast<std::uint8_t>(gf.times(sum, root) ^ (rest[i / 8] >> (56U - 8U * (i % 8)) & 0xFFU));
        syndromes[n] = sum;
    }
    return syndromes;
}

struct Locator {
    Polynomial terms{};
    std::size_t errors = 0;
};

/// The shortest recurrence that makes the syndromes (Berlekamp–Massey): its roots are where the errors are.
Locator locator_of(const Polynomial& syndromes, std::size_t checks) {
    Locator locator;
    Polynomial before{};
    locator.terms[0] = before[0] = 1;
    std::uint8_t before_discrepancy = 1;
    std::size_t shift = 1;
    for (std::size_t n = 0; n < checks; ++n, ++shift) {
        std::uint8_t discrepancy = syndromes[n];
        for (std::size_t i = 1; i <= locator.errors; ++i)
            discrepancy = static_cast<std::uint8_t>(discrepancy ^ gf.times(locator.terms[i], syndromes[n - i]));
        if (discrepancy == 0) continue;
        const Polynomial last = locator.terms;
        const auto factor = gf.over(discrepancy, before_discrepancy);
        for (std::size_t i = shift; i <= checks; ++i)
            locator.terms[i] = static_cast<std::uint8_t>(locator.terms[i] ^ gf.times(factor, before[i - shift]));
        if (2 * locator.errors > n) continue;
        locator.errors = n + 1 - locator.errors;
        before = last;
        before_discrepancy = discrepancy;
        shift = 0;
    }
    return locator;
}

struct Places {
    std::array<unsigned, checks_max / 2> power{};  // of the word's polynomial
    std::size_t size = 0;
};

/// The powers below `symbols` whose inverses the locator has as roots, tried one by one (Chien).
Places places_of(const Locator& locator, std::size_t symbols) {
    Places places;
    std::array<unsigned, checks_max / 2 + 1> logs{}, steps{};
    std::size_t terms = 0;
    for (std::size_t i = 0; i <= locator.errors; ++i) {
        if (locator.terms[i] == 0) continue;
        logs[terms] = gf.log[locator.terms[i]];
        steps[terms] = (order - root_log(static_cast<unsigned>(i))) % order;
        ++terms;
    }
    for (unsigned power = 0; power < symbols && places.size < locator.errors; ++power) {
        unsigned sum = 0;
        for (std::size_t i = 0; i < terms; ++i) {
            sum ^= gf.power[logs[i]];
            logs[i] += steps[i];
            if (logs[i] >= order) logs[i] -= order;
        }
        if (sum == 0) places.power[places.size++] = power;
    }
    return places;
}

/// What is wrong at one place (Forney).
std::uint8_t error_at(unsigned power, const Locator& locator, const Polynomial& evaluator, std::size_t checks) {
    const unsigned inverse_log = (order - root_log(power)) % order;
    const auto inverse = gf.power[inverse_log];
    const auto square = gf.times(inverse, inverse);
    std::uint8_t numerator = 0, derivative = 0;
    for (std::size_t i = locator.errors; i-- > 0;)
        numerator = static_cast<std::uint8_t>(gf.times(numerator, inverse) ^ evaluator[i]);
    for (std::size_t i = (locator.errors - 1) / 2 + 1; i-- > 0;)
        derivative = static_cast<std::uint8_t>(gf.times(derivative, square) ^ locator.terms[2 * i + 1]);
    const auto first_root = static_cast<unsigned>(middle_root - checks / 2);
    return gf.times(gf.power[inverse_log * (first_root - 1) % order], gf.over(numerator, derivative));
}

/// Corrects a word in the conventional basis. @return symbols corrected; none: it cannot be
template <std::size_t checks>
std::optional<std::size_t> correct_word(std::span<std::uint8_t> word) {
    const auto rest = remainder_of<checks>(word);
    if (std::ranges::all_of(rest, [](std::uint64_t each) { return each == 0; })) return 0;
    const Polynomial syndromes = syndromes_of<checks>(rest);
    const Locator locator = locator_of(syndromes, checks);
    if (locator.errors > checks / 2) return std::nullopt;
    const Places places = places_of(locator, word.size());
    if (places.size != locator.errors) return std::nullopt;
    Polynomial evaluator{};
    for (std::size_t i = 0; i < locator.errors; ++i)
        for (std::size_t k = 0; k <= i; ++k)
            evaluator[i] = static_cast<std::uint8_t>(evaluator[i] ^ gf.times(locator.terms[k], syndromes[i - k]));
    for (std::size_t i = 0; i < places.size; ++i)
        word[word.size() - 1 - places.power[i]] ^= error_at(places.power[i], locator, evaluator, checks);
    return places.size;
}

}  // namespace

Correction correct_codeblock(const ReedSolomonCode& code, std::span<std::uint8_t> codeblock) {
    AEOLIS_CHECK(code.fits(codeblock.size()) && (code.check_symbols == 32 || code.check_symbols == 16));
    const bool dual = code.basis == ReedSolomonCode::Basis::dual;
    const std::size_t size = codeblock.size() / code.interleave;
    std::array<std::uint8_t, symbols_max> symbols{};
    const auto word = std::span{symbols}.first(size);
    Correction found;
    for (std::size_t first = 0; first < code.interleave; ++first) {
        for (std::size_t i = 0; i < size; ++i) {
            const auto octet = codeblock[first + i * code.interleave];
            word[i] = dual ? bases.conventional[octet] : octet;
        }
        const auto corrected = code.check_symbols == 32 ? correct_word<32>(word) : correct_word<16>(word);
        if (!corrected) {
            ++found.uncorrectable_words;
            continue;
        }
        if (*corrected == 0) continue;
        found.symbols += *corrected;
        for (std::size_t i = 0; i < size; ++i)
            codeblock[first + i * code.interleave] = dual ? bases.dual[word[i]] : word[i];
    }
    return found;
}

}  // namespace aeolis::telemetry
