// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "telemetry/clock_kernel.hpp"
#include "tests/support/catch.hpp"

#include <string>

// Short SPICE kernels for tests of time.
namespace aeolis::tests {

/// The constants and all leap seconds of NAIF's naif0012, retyped.
inline const std::string leap_second_kernel = R"(KPL/LSK
\begindata
DELTET/DELTA_T_A = 32.184
DELTET/K         = 1.657D-3
DELTET/EB        = 1.671D-2
DELTET/M         = ( 6.239996D0 1.99096871D-7 )
DELTET/DELTA_AT  = ( 10, @1972-JAN-1   11, @1972-JUL-1   12, @1973-JAN-1   13, @1974-JAN-1
                     14, @1975-JAN-1   15, @1976-JAN-1   16, @1977-JAN-1   17, @1978-JAN-1
                     18, @1979-JAN-1   19, @1980-JAN-1   20, @1981-JUL-1   21, @1982-JUL-1
                     22, @1983-JUL-1   23, @1985-JUL-1   24, @1988-JAN-1   25, @1990-JAN-1
                     26, @1991-JAN-1   27, @1992-JUL-1   28, @1993-JUL-1   29, @1994-JUL-1
                     30, @1996-JAN-1   31, @1997-JUL-1   32, @1999-JAN-1   33, @2006-JAN-1
                     34, @2009-JAN-1   35, @2012-JUL-1   36, @2015-JUL-1   37, @2017-JAN-1 )
\begintext
)";

inline telemetry::LeapSeconds leap_seconds() {
    const auto kernel = telemetry::TextKernel::parse(leap_second_kernel, "naif0012.tls");
    REQUIRE(kernel);
    auto leaps = telemetry::LeapSeconds::read(*kernel);
    REQUIRE(leaps);
    return *leaps;
}

inline Result<telemetry::ClockKernel> clock_of(const std::string& assignments) {
    const auto kernel =
        telemetry::TextKernel::parse("KPL/SCLK\n\\begindata\n" + assignments + "\n\\begintext\n", "clock.tsc");
    if (!kernel) return kernel.error();
    return telemetry::ClockKernel::read(*kernel);
}

/// A clock of seconds and 1/65536 s that follows TT through one point: 397501174 is 2012-219T05:10:47.400 UTC.
inline const std::string landing_clock = R"(SCLK_DATA_TYPE_76 = ( 1 )
SCLK01_TIME_SYSTEM_76 = ( 2 )
SCLK01_N_FIELDS_76 = ( 2 )
SCLK01_MODULI_76 = ( 4294967296 65536 )
SCLK01_OFFSETS_76 = ( 0 0 )
SCLK_PARTITION_START_76 = ( 0.0 )
SCLK_PARTITION_END_76 = ( 2.8147497671065E+14 )
SCLK01_COEFFICIENTS_76 = ( 0.0 @2000-JAN-1/12:12:20.584 1.0 ))";

}  // namespace aeolis::tests
