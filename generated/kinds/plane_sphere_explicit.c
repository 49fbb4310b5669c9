/* CasADi 3.8.2 */

/* mg_plane_sphere_explicit_rates */
static int casadi_f4(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem) {
  casadi_real a0, a1;
  a0=arg[2][2];
  a1=arg[5][0];
  a0=(a0-a1);
  res[0][0]=a0;
  a0=0.;
  res[2][0]=a0;
  res[2][1]=a0;
  a1=1.;
  res[2][2]=a1;
  res[3][0]=a0;
  res[5][0]=a0;
  res[5][1]=a0;
  res[5][2]=a1;
  return 0;
}

/* mg_plane_sphere_explicit_place */
static int casadi_f5(const casadi_real** arg, casadi_real** res, casadi_int* iw, casadi_real* w, int mem) {
  casadi_real a0, a1, a2, a3, a4, a5;
  a0=arg[1][2];
  a1=arg[3][0];
  a0=(a0-a1);
  res[1][0]=a0;
  a2=0.;
  res[2][0]=a2;
  res[2][1]=a2;
  a3=1.;
  res[3][0]=a3;
  a1=casadi_fabs(a1);
  a4=(1./a1);
  a4=casadi_sq(a4);
  a5=2.;
  a1=(a5/a1);
  a1=casadi_fabs(a1);
  a1=(a1/a5);
  a5=1.0000000000000001e-30;
  a1=casadi_fmax(a1,a5);
  a4=(a4/a1);
  res[3][1]=a4;
  res[4][0]=a2;
  res[4][1]=a2;
  res[4][2]=a3;
  a3=arg[1][0];
  res[5][0]=a3;
  a4=arg[1][1];
  res[5][1]=a4;
  res[5][2]=a2;
  res[6][0]=a3;
  res[6][1]=a4;
  res[6][2]=a0;
  return 0;
}
