/* The reasons not to trust a run that its own figures show (mg_doubts), and their words. Writes nothing. */
#include "run/run.h"

static const struct {
  int doubt;
  const char *text;
} mg_doubt_texts[] = {
    {MG_DOUBT_ENDED, "the run ended early"},
    {MG_DOUBT_GAP, "the gap of a closed contact is too large"},
    {MG_DOUBT_PENETRATION, "bodies penetrated each other"},
    {MG_DOUBT_JOINT, "a joint was apart"},
    {MG_DOUBT_ENERGY, "the energy changed by more than the work done"},
    {MG_DOUBT_COMPLEMENTARITY, "a contact force pulled, or acted across a gap"},
    {MG_DOUBT_IMPACT_GAIN, "an impact added energy"},
    {MG_DOUBT_NO_GAMMA, "Gamma2 is left out"},
    {MG_DOUBT_TIME_STEPPING, "time-stepping located no events"},
    {MG_DOUBT_SLIP_STOP, "slip died within fixed steps"},
    {MG_DOUBT_INDETERMINATE, "the motion is one of several, or is not proved to be the only one"},
    {MG_DOUBT_FLUSH, "rounding decided whether an edge in the plane of a face was struck"},
    {MG_DOUBT_UNFOLLOWED, "closest points were found that no contact was free to follow"},
    {MG_DOUBT_INCOMPLETE, "a search for closest points was given up"},
    {MG_DOUBT_STAND_IN, "contacts are with a shape that stands for another surface"},
    {MG_DOUBT_CAPACITY, "a capacity was exceeded"},
};

MG_API const char *mg_doubt_text(int doubt) {
  for (size_t k = 0; k < sizeof mg_doubt_texts / sizeof *mg_doubt_texts; k++)
    if (mg_doubt_texts[k].doubt == doubt) return mg_doubt_texts[k].text;
  return "";
}

/* m (L/T)^2, J. */
static mg_real mg_resting_energy(const mg_system *system) {
  const mg_real speed = system->length / system->time;
  return system->mass * speed * speed;
}

MG_API mg_real mg_moved_energy(const mg_system *system, const mg_run *run) {
  const mg_real resting = mg_resting_energy(system);
  return run->report.kinetic_max > MG_EPS * resting ? run->report.kinetic_max : resting;
}

MG_API mg_real mg_energy_rounding(const mg_system *system, const mg_run *run) {
  const mg_real energies = mg_resting_energy(system) + fabs(run->report.energy_0) + run->report.kinetic_max;
  return ((mg_real)run->steps + 1) * MG_EPS * energies;
}

MG_API int mg_doubts(const mg_system *system, const mg_settings *settings, const mg_run *run, int outcome) {
  const mg_real gap = settings->gap_error_max * system->length,
                energy = settings->energy_error_max * mg_moved_energy(system, run),
                lost = run->report.energy_error_max + run->report.correction_energy;
  int found = 0;
  if (outcome >= MG_PENETRATION) found |= MG_DOUBT_ENDED;
  if (!(run->report.gap_max <= gap)) found |= MG_DOUBT_GAP;
  if (!(run->report.penetration_max <= gap)) found |= MG_DOUBT_PENETRATION;
  if (!(run->report.joint_error_max <= settings->start_joint_gap * system->length)) found |= MG_DOUBT_JOINT;
  if (!(lost <= mg_max(energy, mg_energy_rounding(system, run)))) found |= MG_DOUBT_ENERGY;
  if (!(run->report.complementarity_max <= settings->complementarity_error_max)) found |= MG_DOUBT_COMPLEMENTARITY;
  if (!(run->report.impact_gain_max <= energy)) found |= MG_DOUBT_IMPACT_GAIN;
  if (!settings->use_gamma && system->n_pair) found |= MG_DOUBT_NO_GAMMA;
  if (settings->method == MG_TIME_STEPPING || run->report.fallbacks || run->report.chatters)
    found |= MG_DOUBT_TIME_STEPPING;
  if (settings->method == MG_RK4 && run->report.slip_stops) found |= MG_DOUBT_SLIP_STOP;
  if (run->report.indeterminate) found |= MG_DOUBT_INDETERMINATE;
  if (run->report.flush_contact >= 0) found |= MG_DOUBT_FLUSH;
  if (run->report.unfollowed_minima) found |= MG_DOUBT_UNFOLLOWED;
  if (run->report.incomplete_searches) found |= MG_DOUBT_INCOMPLETE;
  if (system->n_stand_in) found |= MG_DOUBT_STAND_IN;
  for (int k = 0; k < MG_CAPACITIES; k++)
    if (run->report.exceeded[k]) found |= MG_DOUBT_CAPACITY;
  return found;
}
