using System;
using System.Collections.Generic;
using System.Reflection;

namespace UnityEngine
{
    /// <summary>What calls the components, frame by frame. Not in Unity.</summary>
    public static class Engine
    {
        private static readonly List<MonoBehaviour> Behaviours = new List<MonoBehaviour>();

        /// <summary>Whether components run; those that are added before, begin with <see cref="Play"/>.</summary>
        public static bool Playing { get; private set; }

        /// <summary>How many there are.</summary>
        public static int Count
        {
            get { return Behaviours.Count; }
        }

        /// <summary>Play mode begins, as it does where the domain is not loaded anew.</summary>
        public static void Play(params Assembly[] assemblies)
        {
            foreach (Assembly assembly in assemblies)
            {
                foreach (Type type in assembly.GetTypes())
                {
                    Begin(type);
                }
            }
            Playing = true;
        }

        /// <summary>A frame: Start where it is due, Update, LateUpdate.</summary>
        public static void Frame()
        {
            for (int i = 0; i < Behaviours.Count; i++)
            {
                if (Behaviours[i].On && !Behaviours[i].Started)
                {
                    Behaviours[i].Started = true;
                    Behaviours[i].Send("Start");
                }
            }
            Send("Update");
            Send("LateUpdate");
        }

        /// <summary>Calls a message of all that are enabled.</summary>
        public static void Send(string message)
        {
            for (int i = 0; i < Behaviours.Count; i++)
            {
                if (Behaviours[i].On)
                {
                    Behaviours[i].Send(message);
                }
            }
        }

        /// <summary>Play mode ends: all are told, disabled and destroyed.</summary>
        public static void Quit()
        {
            Send("OnApplicationQuit");
            foreach (MonoBehaviour behaviour in Behaviours.ToArray())
            {
                if (!behaviour.Destroyed)
                {
                    behaviour.enabled = false;
                    behaviour.Send("OnDestroy");
                    behaviour.Destroyed = true;
                }
            }
            Behaviours.Clear();
            Playing = false;
        }

        internal static void Add(MonoBehaviour behaviour)
        {
            int at = Behaviours.Count;
            while (at > 0 && Behaviours[at - 1].Order > behaviour.Order)
            {
                at--;
            }
            Behaviours.Insert(at, behaviour);
        }

        private static void Begin(Type type)
        {
            const BindingFlags All = BindingFlags.Static | BindingFlags.Public | BindingFlags.NonPublic;
            foreach (MethodInfo method in type.GetMethods(All))
            {
                if (method.IsDefined(typeof(RuntimeInitializeOnLoadMethodAttribute), false))
                {
                    method.Invoke(null, null);
                }
            }
        }
    }
}
