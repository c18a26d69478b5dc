using NUnit.Framework;
using Pacinian.Wire;
using UnityEngine;

namespace Pacinian.Haptics.Tests
{
    public sealed class EnvelopeTests
    {
        private HapticEnvelope _envelope;

        [SetUp]
        public void Make()
        {
            _envelope = ScriptableObject.CreateInstance<HapticEnvelope>();
        }

        [TearDown]
        public void Clean()
        {
            UnityEngine.Object.DestroyImmediate(_envelope);
        }

        [TestCase(EnvelopeKind.Constant)]
        [TestCase(EnvelopeKind.Sine)]
        [TestCase(EnvelopeKind.Square)]
        [TestCase(EnvelopeKind.Pulse)]
        [TestCase(EnvelopeKind.Noise)]
        [TestCase(EnvelopeKind.Preset)]
        [TestCase(EnvelopeKind.Wave)]
        [TestCase(EnvelopeKind.Curve)]
        public void EachIsTaken(EnvelopeKind kind)
        {
            _envelope.Clip = Tone(48000, 2, 4800);
            _envelope.Kind = kind;
            Point point = new Point { RadiationPressure = 1.0, Envelope = _envelope.Message };
            Assert.AreEqual("", ObjectValidation.Problem(point));
            Assert.AreEqual(kind == EnvelopeKind.Curve ? "Wave" : kind.ToString(), point.Envelope.GetType().Name);
            Assert.AreEqual("", _envelope.Problem);
        }

        [Test]
        public void ItIsMadeOnceForEachChange()
        {
            IEnvelope first = _envelope.Message;
            int version = _envelope.Version;
            Assert.IsTrue(ReferenceEquals(first, _envelope.Message));
            _envelope.Frequency = 40f;
            Assert.IsTrue(_envelope.Version > version);
            Assert.AreEqual(40.0, ((Sine)_envelope.Message).Frequency, 0.0);
        }

        [Test]
        public void WhatIsOutOfRangeIsBroughtIn()
        {
            _envelope.High = 7f;
            _envelope.Low = -1f;
            _envelope.Frequency = 1e6f;
            Assert.AreEqual("", ObjectValidation.Problem(new Point { RadiationPressure = 1.0, Envelope = _envelope.Message }));
        }

        [Test]
        public void AClipIsMonoAndSlowEnough()
        {
            string problem;
            Wave wave = AudioWave.Of(Tone(48000, 2, 4800), out problem);
            Assert.AreEqual(8000.0, wave.Rate, 0.0);
            Assert.AreEqual(800, wave.Samples.Numbers);
            Assert.AreEqual(0.25, wave.Samples.Single(0), 1e-6, "mean of 0.5 and 0");
        }

        [Test]
        public void AClipThatIsTooLongIsCutAndOneThatIsMissingIsTold()
        {
            string problem;
            Wave wave = AudioWave.Of(Tone(8000, 1, 300000), out problem);
            Assert.AreEqual(Protocol.MaxValues, wave.Samples.Numbers);
            Assert.AreEqual("its wave is cut after 25 s", problem);
            _envelope.Kind = EnvelopeKind.Wave;
            Assert.IsTrue(_envelope.Message is Constant);
            Assert.AreEqual("has no clip and no samples", _envelope.Problem);
            _envelope.Samples = new[] { 0f, 1f, -1f };
            Assert.AreEqual(1000.0, ((Wave)_envelope.Message).Rate, 0.0);
        }

        [Test]
        public void ACurveIsAWaveFromItsFirstSecondToItsLastKey()
        {
            _envelope.Kind = EnvelopeKind.Curve;
            _envelope.Loop = false;
            _envelope.Curve = new AnimationCurve(new Keyframe(0f, 0f), new Keyframe(0.25f, 1f), new Keyframe(0.5f, 3f));
            Wave wave = (Wave)_envelope.Message;
            Assert.IsFalse(wave.Loop);
            Assert.AreEqual(0.5, wave.Samples.Numbers / wave.Rate, 1e-6);
            Assert.AreEqual(-1.0, wave.Samples.Single(0), 1e-6, "0: no pressure");
            Assert.AreEqual(0.0, wave.Samples.Single(250), 1e-6, "half of the way up");
            Assert.AreEqual(1.0, wave.Samples.Single(999), 1e-6, "more than 1 is 1");
            _envelope.Curve = new AnimationCurve(new Keyframe(0f, 0f), new Keyframe(1000f, 1f));
            wave = (Wave)_envelope.Message;
            Assert.AreEqual(1000.0, wave.Samples.Numbers / wave.Rate, 1e-3);
            _envelope.Curve = new AnimationCurve();
            Assert.IsTrue(_envelope.Message is Constant);
            Assert.AreEqual("its curve has no key after 0 s", _envelope.Problem);
        }

        private static AudioClip Tone(int rate, int channels, int samples)
        {
            AudioClip clip = AudioClip.Create("tone", samples, channels, rate, false);
            float[] data = new float[samples * channels];
            for (int i = 0; i < data.Length; i += channels)
            {
                data[i] = 0.5f;
            }
            clip.SetData(data, 0);
            return clip;
        }
    }
}
