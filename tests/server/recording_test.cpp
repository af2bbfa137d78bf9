// SPDX-License-Identifier: Apache-2.0
#include "server/tones/recording.hpp"

#include "server/tones/sample_file.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/temporary_folder.hpp"

#include <filesystem>
#include <fstream>

namespace server_recording_test {

using namespace aeolis;
using namespace aeolis::server;

namespace {

std::filesystem::path written(const std::filesystem::path& file, const std::string& octets) {
    std::ofstream{file, std::ios::binary} << octets;
    return file;
}

std::string number(std::uint64_t value, int octets) {
    std::string text;
    for (int i = 0; i < octets; ++i) text.push_back(static_cast<char>(value >> (8 * i) & 0xff));
    return text;
}

std::string chunk(const std::string& name, const std::string& body) {
    return name + number(body.size(), 4) + body + (body.size() % 2 == 1 ? std::string(1, '\0') : std::string{});
}

/// A WAV file whose chunks before the data are `before`.
std::string wav(unsigned code, unsigned channels, unsigned bits, const std::string& data,
                const std::string& before = {}) {
    const unsigned align = channels * bits / 8;
    const std::string body = "WAVE" + before +
                             chunk("fmt ", number(code, 2) + number(channels, 2) + number(16384, 4) +
                                               number(16384 * align, 4) + number(align, 2) + number(bits, 2)) +
                             chunk("data", data);
    return "RIFF" + number(body.size(), 4) + body;
}

std::string refusal(const std::filesystem::path& file) {
    const auto looked = look_at_recording(file);
    REQUIRE_FALSE(looked);
    CHECK(looked.error().message.find('\n') == std::string::npos);
    return looked.error().message;
}

std::vector<std::complex<float>> samples_of(const std::filesystem::path& file) {
    const auto recording = look_at_recording(file);
    INFO(file);
    REQUIRE(recording);
    auto reader = SampleReader::open(*recording);
    REQUIRE(reader);
    std::vector<std::complex<float>> room(100);
    return std::vector<std::complex<float>>(room.begin(), room.begin() + std::ssize(*reader->next(room)));
}

}  // namespace

TEST_CASE("numbers of every format are read in both orders of octets", "[tones][R56]") {
    const std::vector<std::complex<float>> samples{{1.0F, -2.0F}, {0.5F, 100.0F}};
    for (const char* name : {"cf32", "cf64", "ci8", "ci16", "ci32", "cf32_be", "cf64_be", "ci16_be", "ci32_le"}) {
        const auto format = sample_format(name);
        REQUIRE(format);
        CHECK(sample_format(format->name()).value() == *format);
        std::vector<char> octets;
        format->encode(samples, 1.0, octets);
        REQUIRE(octets.size() == 2 * format->octets_a_sample());
        std::vector<std::complex<float>> back(2);
        format->decode(octets, back);
        INFO(name);
        CHECK(back[0] == samples[0]);
        CHECK(std::abs(back[1] - samples[1]) <= 0.5F);
    }
    const std::vector<char> octets{'\x12', '\x34', '\xff', '\xfe'};
    std::vector<std::complex<float>> one(1);
    sample_format("ci16_be")->decode(octets, one);
    CHECK(one[0] == std::complex<float>{0x1234, -2.0F});
    sample_format("ci16_le")->decode(octets, one);
    CHECK(one[0] == std::complex<float>{0x3412, static_cast<float>(0xfeff - 0x10000)});
    const std::vector<char> unsigned_octets{'\x80', '\x00'};
    sample_format("cu8")->decode(unsigned_octets, one);
    CHECK(one[0] == std::complex<float>{0.5F, -127.5F});
    CHECK(sample_format("rf32_le").error().message.find("real samples") != std::string::npos);
    CHECK_FALSE(sample_format("ci24"));
}

TEST_CASE("of WAV the header is never samples, whatever comes before the data", "[tones][R56]") {
    const test::TemporaryFolder folder;
    const std::string two = number(3, 2) + number(0xffff, 2) + number(5, 2) + number(7, 2);
    const std::vector<std::complex<float>> expected{{3.0F, -1.0F}, {5.0F, 7.0F}};
    CHECK(samples_of(written(folder / "a.wav", wav(1, 2, 16, two))) == expected);
    CHECK(samples_of(written(folder / "b.raw", wav(1, 2, 16, two, chunk("auxi", "odd")))) == expected);
    const std::string wide = number(3, 3) + number(0xffffff, 3) + number(5, 3) + number(7, 3);
    CHECK(samples_of(written(folder / "c.wav", wav(1, 2, 24, wide))) == expected);
    std::string long_file = wav(1, 2, 16, two, chunk("ds64", number(0, 8) + number(8, 8) + number(2, 8)));
    long_file.replace(0, 4, "RF64").replace(4, 4, number(0xffffffff, 4));
    long_file.replace(long_file.find("data") + 4, 4, number(0xffffffff, 4));
    CHECK(samples_of(written(folder / "d.wav", long_file + "no samples any more")) == expected);
    std::string stopped = wav(1, 2, 16, two);  // by a recorder that was cut off
    stopped.replace(stopped.find("data") + 4, 4, number(0, 4));
    CHECK(samples_of(written(folder / "e.wav", stopped)) == expected);
    const auto recording = look_at_recording(folder / "a.wav");
    CHECK(recording->rate_hz == 16384.0);
    CHECK(recording->kind == "WAV");
    std::string cut = wav(1, 2, 16, two);
    cut.resize(cut.size() - 3);
    CHECK(look_at_recording(written(folder / "f.wav", cut))->told.size() == 1);

    CHECK(refusal(written(folder / "mono.wav", wav(1, 1, 16, two))).find("one channel, audio") != std::string::npos);
    CHECK(refusal(written(folder / "six.wav", wav(1, 6, 16, two))).find("6 channels") != std::string::npos);
    CHECK(refusal(written(folder / "law.wav", wav(7, 2, 8, two))).find("encoding 7") != std::string::npos);
    CHECK(refusal(written(folder / "none.wav", "RIFF" + number(4, 4) + "WAVE")).find("no data chunk") !=
          std::string::npos);
}

TEST_CASE("what SigMF says of itself is used: its layout, rate, frequency, time and headers", "[tones][R56]") {
    const test::TemporaryFolder folder;
    const auto meta = [&](const std::string& global, const std::string& captures = "[]") {
        return written(folder / "r.sigmf-meta",
                       R"({"global": {)" + global + R"(}, "captures": )" + captures + R"(, "annotations": []})");
    };
    written(folder / "r.sigmf-data", std::string("HEADER") + number(3, 2) + number(0xffff, 2) + "xyz");
    const std::string plain = R"("core:datatype": "ci16_le", "core:sample_rate": 48000, "core:version": "1.0.0")";
    const auto file = meta(plain + R"(, "core:trailing_bytes": 3)",
                           R"([{"core:sample_start": 0, "core:header_bytes": 6, "core:frequency": 8.4e9,
                               "core:datetime": "2012-08-06T05:10:47Z"}])");
    for (const char* either : {"r.sigmf-meta", "r.sigmf-data"}) {
        CHECK(samples_of(folder / either) == std::vector<std::complex<float>>{{3.0F, -1.0F}});
        const auto recording = look_at_recording(folder / either);
        CHECK(recording->rate_hz == 48000.0);
        CHECK(recording->frequency_hz == 8.4e9);
        CHECK(recording->datetime == "2012-08-06T05:10:47Z");
    }
    const std::vector<std::pair<std::string, std::string>> refused{
        {R"("core:sample_rate": 1)", "core:datatype is missing"},
        {R"("core:datatype": "rf32_le")", "real samples"},
        {R"("core:datatype": "ci16_le", "core:num_channels": 2)", "2 channels"},
        {R"("core:datatype": "ci16_le", "core:sample_rate": "fast")", "core:sample_rate is no number"},
        {R"("core:datatype": "ci16_le", "core:dataset": "../other.bin")", "core:dataset"},
        {R"("core:datatype": "ci16_le", "core:trailing_bytes": 99)", "fewer than its headers"}};
    for (const auto& [global, says] : refused) {
        INFO(global);
        CHECK(refusal(meta(global)).find(says) != std::string::npos);
    }
    CHECK(refusal(meta(plain, R"([{"core:header_bytes": -1}])")).find("no count") != std::string::npos);
    CHECK(refusal(written(folder / "r.sigmf-meta", "no JSON")).find("no JSON object") != std::string::npos);
    std::filesystem::remove(folder / "r.sigmf-meta");
    CHECK(refusal(folder / "r.sigmf-data").find("r.sigmf-meta is missing") != std::string::npos);
}

TEST_CASE("a SigMF capture with a later time comes after a gap of that length, and one that cannot be is refused",
          "[tones][R56]") {
    const test::TemporaryFolder folder;
    std::string octets;
    for (unsigned i = 1; i <= 10; ++i) octets += number(i, 2) + number(0, 2);
    written(folder / "r.sigmf-data", octets);
    const auto meta = [&](const std::string& captures, const std::string& global = {}) {
        return written(folder / "r.sigmf-meta", R"({"global": {"core:datatype": "ci16_le", "core:sample_rate": 10)" +
                                                    global + R"(}, "captures": [)" + captures +
                                                    R"(], "annotations": []})");
    };
    const auto capture = [](int start, const std::string& datetime, const std::string& more = {}) {
        return R"({"core:sample_start": )" + std::to_string(start) +
               (datetime.empty() ? "" : R"(, "core:datetime": ")" + datetime + '"') + more + "}";
    };
    const auto heard = [&](const std::filesystem::path& file) {
        const auto recording = look_at_recording(file);
        REQUIRE(recording);
        auto reader = SampleReader::open(*recording);
        REQUIRE(reader);
        std::vector<float> all;
        std::vector<std::complex<float>> room(4);
        for (auto block = reader->next(room); block && !block->empty(); block = reader->next(room))
            for (const auto& sample : *block) all.push_back(sample.real());
        CHECK(reader->samples() == all.size());
        return all;
    };
    // 5 samples take half a second; the sixth came 0.8 s after the first, so that 3 are missing.
    CHECK(heard(meta(capture(0, "2012-08-06T05:10:47.123456789Z") + "," + capture(5, "2012-08-06T05:10:47.923457Z"))) ==
          std::vector<float>{1, 2, 3, 4, 5, 0, 0, 0, 6, 7, 8, 9, 10});
    const std::vector<float> without_gap{1, 2, 3, 4, 5, 6, 7, 8, 9, 10};
    CHECK(heard(meta(capture(0, "2012-08-06T05:10:47.1Z") + "," + capture(5, ""))) == without_gap);
    // A time in whole seconds says no more than that.
    CHECK(heard(meta(capture(0, "2012-08-06T05:10:47Z") + "," + capture(5, "2012-08-06T05:10:47Z"))) == without_gap);
    CHECK(heard(meta(capture(100, "2012-08-06T05:10:47Z") + "," + capture(105, "2012-08-06T05:10:57Z"),
                     R"(, "core:offset": 100)"))
              .size() == 10 + 95);
    {
        const auto recording = look_at_recording(folder / "r.sigmf-meta");
        auto reader = SampleReader::open(*recording);
        std::vector<std::complex<float>> room(8);
        CHECK(reader->next(room)->size() == 5);
        CHECK(reader->next(room)->size() == 8);
        CHECK(reader->skip_hole() == 95 - 8);
        CHECK(reader->next(room)->front().real() == 6.0F);
    }
    const std::string first = capture(0, "2012-08-06T05:10:47Z") + ",";
    const std::vector<std::pair<std::string, std::string>> refused{
        {capture(0, "not a time"), "capture 1 has a core:datetime that is no UTC time: 'not a time'"},
        {first + R"({"core:sample_start": 5, "core:datetime": 7})", "capture 2 has a core:datetime that is no UTC"},
        {first + capture(11, ""), "capture 2 begins at sample 11, behind the end of r.sigmf-data"},
        {first + capture(5, "") + "," + capture(4, ""), "capture 3 begins before the one before it"},
        {capture(0, "", R"(, "core:frequency": "X")"), "capture 1 has a core:frequency that is no number"}};
    for (const auto& [captures, says] : refused)
        CHECK_THAT(refusal(meta(captures)), Catch::Contains("r.sigmf-meta: ") && Catch::Contains(says));
    CHECK_THAT(refusal(meta(first, R"(, "core:offset": 3)")), Catch::Contains("before core:offset, 3"));
    for (const auto& [time, says] : {std::pair{"2012-08-06T05:10:40Z", "capture 2 is 7.500 s earlier than"},
                                     {"2013-08-06T05:10:47Z", "capture 2 is 31536000 s after the samples before it"}}) {
        const auto recording = look_at_recording(meta(first + capture(5, time)));
        REQUIRE(recording);
        const auto opened = SampleReader::open(*recording);
        REQUIRE_FALSE(opened);
        CHECK_THAT(opened.error().message, Catch::Contains("r.sigmf-meta: ") && Catch::Contains(says));
    }
    const auto told = look_at_recording(
        meta(capture(0, "", R"(, "core:frequency": 8.4e9)") + "," + capture(5, "", R"(, "core:frequency": 2.2e9)")));
    REQUIRE(told);
    REQUIRE(told->told.size() == 1);
    CHECK_THAT(told->told.front(), Catch::Contains("capture 2 is at 2200000000 Hz, not at 8400000000 Hz"));
}

TEST_CASE("what other files are is told in one line", "[tones][R56]") {
    const test::TemporaryFolder folder;
    CHECK(refusal(written(folder / "x.cf32", "fLaC and more")).find("is FLAC audio") != std::string::npos);
    CHECK(refusal(written(folder / "y.cf32", "\x1f\x8b\x08 and more")).find("gzip") != std::string::npos);
    CHECK(refusal(folder / "nothing").find("no such file") != std::string::npos);
    CHECK(refusal(written(folder / "z.sigmf", "")).find("tar") != std::string::npos);
    const auto raw = look_at_recording(written(folder / "raw.cf32", std::string(100, '\0')));
    REQUIRE(raw);
    CHECK_FALSE(raw->format);
    CHECK_FALSE(raw->rate_hz);
    auto empty = *look_at_recording(written(folder / "empty.cf32", ""));
    empty.format = SampleFormat::cf32;
    CHECK(SampleReader::open(empty).error().message.ends_with("is empty"));
}

TEST_CASE("a file of a hundred gigabytes with nothing in it is passed over", "[tones][R56]") {
    const test::TemporaryFolder folder;
    const auto file = written(folder / "vast.cf32", std::string(80, 'x'));
    std::error_code error;
    std::filesystem::resize_file(file, 100'000'000'000U, error);
    if (error) return;
    auto reader = SampleReader::open(file, SampleFormat::cf32);
    REQUIRE(reader);
    CHECK(reader->samples() == 12'500'000'000U);
    std::vector<std::complex<float>> room(65536);
    REQUIRE(reader->next(room));
    const std::uint64_t skipped = reader->skip_hole();
    CHECK((skipped == 0 || skipped == 12'500'000'000U - 65536U));  // 0 where holes are not known
}

}  // namespace server_recording_test
