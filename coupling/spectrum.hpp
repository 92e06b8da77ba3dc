#pragma once
// Spectra of probes: the Fourier amplitude of the samples of the measured stage, their mean taken off,
//   X(f_k) = |dt sum_n (x_n - mean) exp(-2 pi i f_k t_n)|,  f_k = k / (N dt)                        [unit s]
// smoothed as engineering seismology does: the power X^2 is averaged over neighbouring frequencies with the spectral
// window of Parzen,
//   W(f) = 3/4 u (sin(pi u f / 2) / (pi u f / 2))^4,  u = 280 / (151 b),  b the bandwidth [Hz]
// (b = 1 / integral of W^2 over frequency), and the root is taken. A mobility is the smoothed spectrum of a velocity
// over that of a load (Nishiura2017 4.2, Figures 9 and 12: bandwidth 20 Hz; DOI 10.3390/ma10060615). Samples are
// brought to even steps by straight lines first; frequencies end at half the sampling rate.
#include <span>
#include <string>
#include <vector>

#include "coupling/results.hpp"

namespace coupling {

struct Spectrum {
  std::vector<double> frequency;  // [Hz] from 0, even steps
  std::vector<double> amplitude;  // [unit s]
};

/// `bandwidth` [Hz] of Parzen's window; 0: as it is. Empty with fewer than four samples.
Spectrum spectrum(std::span<const double> time, std::span<const double> values, double bandwidth);

/// spectra.csv of the scene: one column for each [[spectrum]]; empty where there is none, or too few samples.
std::string spectra_text(const Scene&, const Series&);

}  // namespace coupling
