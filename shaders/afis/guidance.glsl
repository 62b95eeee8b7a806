// Computes the number of samples of a pixel from the variance of its earlier results: SPVG and
// control variates (Xie and others 2021; ids of docs/papers.md).
// integration/tools/references/guidance.hpp mirrors these functions under the same names.
#ifndef DERMIS_GUIDANCE_GLSL
#define DERMIS_GUIDANCE_GLSL

// Settings of subsurface.guided, under the same names.
struct guidance_settings {
  float sigma2_target, kappa, eta, eta_cv, eps_alpha;
  int min_samples, max_samples;
};

// Returns kappa * Delta + E, not clamped (equations 8 to 10, A4).
float required_samples(float variance, float mean_count, guidance_settings settings) {
  float ratio = variance / settings.sigma2_target;
  float change = (ratio - 1.0) * mean_count * (2.0 / settings.eta - 2.0);
  return settings.kappa * change + ratio * mean_count;
}

// Returns a whole number within the range (A6).
int clamped_samples(float required, guidance_settings settings) {
  return int(round(clamp(required, float(settings.min_samples), float(settings.max_samples))));
}

struct moving_variance {
  float mean, variance;
};
// Equations 5 and 6 (A1, A2).
moving_variance add_value(moving_variance moments, float x, float eta) {
  float delta = x - moments.mean;
  return moving_variance(moments.mean + eta * delta,
                         (1.0 - eta) * (moments.variance + eta * delta * delta));
}

struct moving_covariance {
  float mean_f, mean_g, covariance, variance_g;
};
// Equation 32 (C5).
moving_covariance add_values(moving_covariance moments, float f, float g, float eta) {
  float delta_f = f - moments.mean_f, delta_g = g - moments.mean_g;
  return moving_covariance(moments.mean_f + eta * delta_f, moments.mean_g + eta * delta_g,
                           (1.0 - eta) * (moments.covariance + eta * delta_f * delta_g),
                           (1.0 - eta) * (moments.variance_g + eta * delta_g * delta_g));
}

// Algorithm 2 (C10). The bound is not applied if the mean of g is 0.
float control_weight(moving_covariance moments, float eps_alpha) {
  float weight = (moments.covariance + eps_alpha) / (moments.variance_g + eps_alpha);
  return moments.mean_g > 0.0
             ? clamp(weight, 0.0, (moments.mean_f + moments.mean_g) / moments.mean_g)
             : weight;
}

#endif
